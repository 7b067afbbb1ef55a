// Thresholds of the tunnelling guard, and the steps that it chooses.
#include "contact/base/error.hpp"
#include "miniapp/simulation/tunnelling_guard.hpp"

#include <gtest/gtest.h>

namespace {

using namespace brickwall;
using namespace brickwall::miniapp;

constexpr double reach = 0.1, step = 0.5;

TunnellingGuard guardThat(GuardAction action, double penalty = 0.75) { // allowed: reach/2
  Config config;
  config.contact.guard = action;
  config.contact.penalty = penalty;
  return {config, reach, step};
}

const io::MeshPart no_mesh;
const EntityNames names(MPI_COMM_SELF, no_mesh);

contact::PairMotion movingBy(double motion) {
  contact::PairMotion pair;
  pair.motion = motion;
  return pair;
}

TEST(TunnellingGuard, ActsAtTheAllowedMotionAndEarlyAtTwoThirdsOfIt) {
  const auto guard = guardThat(GuardAction::cut);
  EXPECT_DOUBLE_EQ(guard.allowedMotion(step), reach / 2);
  EXPECT_DOUBLE_EQ(guard.allowedMotion(step / 4), reach / 8);
  EXPECT_DOUBLE_EQ(guard.tolerableMotion(step, false), reach / 2);
  EXPECT_DOUBLE_EQ(guard.tolerableMotion(step, true), reach / 3);
  EXPECT_DOUBLE_EQ(guardThat(GuardAction::stop).tolerableMotion(step, true), reach / 2);
}

TEST(TunnellingGuard, ACutMovesThePairBelowTheThreshold) {
  for (const bool is_early : {false, true})
    for (const double speed : {0.07, 0.1, 0.3, 2.0}) { // length/time
      auto guard = guardThat(GuardAction::cut);
      if (!(speed * step > guard.tolerableMotion(step, is_early)))
        continue;
      const double dt = guard.shorten(step, movingBy(speed * step), is_early, 1, 0.0, names);
      EXPECT_LE(dt, step);
      EXPECT_GE(guard.referenceStep(), dt) << speed;
      EXPECT_LT(guard.referenceStep(), step) << speed;
      EXPECT_LT(speed * dt, guard.tolerableMotion(dt, is_early)) << speed;
      EXPECT_NEAR(speed * guard.referenceStep(), (is_early ? 0.6 : 0.75) * reach / 2, 1e-15);
    }
}

TEST(TunnellingGuard, RefusesAStepThatIsTooShort) {
  auto guard = guardThat(GuardAction::cut);
  EXPECT_THROW(guard.shorten(step, movingBy(1e3), false, 1, 0.0, names), PhysicsError);
}

TEST(TunnellingGuard, NamesThePenaltyWhereItMakesContactSoft) {
  for (const double penalty : {0.75, 0.001})
    try {
      guardThat(GuardAction::cut, penalty).shorten(step, movingBy(1e3), false, 1, 0.0, names);
      FAIL() << "no error";
    } catch (const PhysicsError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.find("contact.penalty helps too; it is 0.001") != std::string::npos,
                penalty < 0.5)
          << message;
    }
}

} // namespace
