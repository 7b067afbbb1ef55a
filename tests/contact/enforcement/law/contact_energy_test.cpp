// Energy of impacts of elastic bricks, by the half-step energy: the error of each scheme. The
// bricks consist of springs, so that no other part of the program is needed. Momentum checks do not
// see these errors.
#include "contact/enforcement/node_face/node_face_kinematics.hpp"
#include "tests/contact/enforcement/support/spring_bricks.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact::testing {
namespace {

struct Impact {
  Scene scene;
  std::vector<Vec3> velocity;

  void launch(int body, const Vec3& v, const Vec3& spin = {}) {
    velocity.resize(scene.x_new.size());
    Vec3 sum;
    int count = 0;
    for (std::size_t i = 0; i < velocity.size(); ++i)
      if (scene.node_body[i] == body) {
        sum += scene.x_new[i];
        ++count;
      }
    const Vec3 centre = (1.0 / count) * sum;
    for (std::size_t i = 0; i < velocity.size(); ++i)
      if (scene.node_body[i] == body)
        velocity[i] = v + cross(spin, scene.x_new[i] - centre);
  }
};

// Worst |E/E_0 - 1| over `steps`. E_0 is the initial kinetic energy.
double worstEnergyError(const Impact& impact, Scheme scheme, int steps) {
  EnforcementConfig config;
  config.scheme = scheme;
  SpringBricks bricks(impact.scene, config, 0.1, 0.8, 0.1);
  bricks.velocity = impact.velocity;
  double start = 0, worst = 0;
  for (int step = 0; step < steps; ++step) {
    bricks.step();
    if (step == 0)
      start = bricks.energy;
    worst = std::max(worst, std::fabs(bricks.energy / start - 1));
    EXPECT_EQ(bricks.sums.problem(), "");
  }
  EXPECT_EQ(bricks.sums.active, 0) << "the bricks should have parted again";
  return worst;
}

// Contacts that share nodes change each other's work. Each of the three rounds of correction leaves
// less than a third of the error of the round before, the first of that of the penalty scheme.
constexpr double remaining_error = 1.0 / 27;

// Two elements of free nodes, so soft that only contact acts: energy is exact except for the finite
// number of rounds.
TEST(ContactEnergy, EnergyNeutralBounceOfFreeNodesKeepsTheEnergy) {
  Impact impact;
  impact.scene.addBox({0, 0, 0}, {1, 1, 1}, {1, 1, 1});
  impact.scene.addBox({0, 0, 1.0004}, {1, 1, 1}, {1, 1, 1});
  impact.launch(0, {});
  impact.launch(1, {0, 0, -0.01});
  const double penalty = worstEnergyError(impact, Scheme::penalty, 60);
  const double neutral = worstEnergyError(impact, Scheme::energy_neutral, 60);
  EXPECT_GT(penalty, 1e-2); // first and last step of the contact
  EXPECT_LT(neutral, remaining_error * penalty);
}

// The penalty scheme errs by 0.9 % here and by 3.9 % in the next case.
TEST(ContactEnergy, EnergyNeutralObliqueImpactKeepsTheEnergy) {
  Impact impact;
  impact.scene.addBox({0, 0, 0}, {2, 1, 1}, {8, 4, 4});
  impact.scene.addBrick({2, 1, 1}, {8, 4, 4}, 1, [](const Vec3& p) {
    const double c = std::cos(0.1), s = std::sin(0.1), x = p.x - 1;
    return Vec3{1.383 + x * c - p.z * s, 0.11 + p.y, 1.13 + x * s + p.z * c};
  });
  impact.launch(0, {0, 0, 0.01});
  impact.launch(1, {0.003, 0, -0.01}, {0, 0.005, 0});
  const double penalty = worstEnergyError(impact, Scheme::penalty, 700);
  const double neutral = worstEnergyError(impact, Scheme::energy_neutral, 700);
  EXPECT_LT(penalty, 2e-2);
  EXPECT_LT(neutral, remaining_error * penalty);
}

TEST(ContactEnergy, EnergyNeutralImpactOnAJointKeepsTheEnergy) {
  Impact impact;
  impact.scene.addBox({0, 0, 0}, {2, 1, 1}, {4, 2, 2});
  impact.scene.addBox({2, 0, 0}, {2, 1, 1}, {4, 2, 2});
  impact.scene.addBox({1, 0, 1.01}, {2, 1, 1}, {4, 2, 2});
  impact.launch(0, {});
  impact.launch(2, {0, 0, -0.01});
  const double penalty = worstEnergyError(impact, Scheme::penalty, 700);
  const double neutral = worstEnergyError(impact, Scheme::energy_neutral, 700);
  EXPECT_LT(penalty, 4e-2);
  EXPECT_LT(neutral, remaining_error * penalty);
}

// Sixteen and more contacts at the common corner of four bricks begin and end together.
TEST(ContactEnergy, FlushImpactOnFourBricksKeepsTheEnergy) {
  for (const int elements : {1, 2}) {
    Impact impact;
    for (const double x : {0.0, 1.0})
      for (const double y : {0.0, 1.0})
        impact.scene.addBox({x, y, 0}, {1, 1, 1}, {elements, elements, elements});
    impact.scene.addBox({0, 0, 1.001}, {2, 2, 1}, {4, 3, 1});
    impact.launch(0, {});
    impact.launch(4, {0, 0, -0.01});
    EXPECT_LT(worstEnergyError(impact, Scheme::energy_neutral, 700), 5e-3) << elements;
  }
}

// A spring on which `work` was done and that holds the energy `held`.
double offsetAfter(double work, double held, double offset = 0.1, double fade_weight = 0.5) {
  ContactState<double> spring;
  spring.stiffness = 3.0;
  spring.fade_weight = fade_weight;
  spring.depth = 0.2;
  spring.offset = offset;
  spring.stored = work;
  spring.spring_energy = held;
  return ContactLaw::adjustedOffset(spring);
}

// A block's edge is pressed into a valley and slips sideways, farther beyond the end of its face than
// contacts are retained.
// Sticking friction is an elastic spring, which may hold energy when its contact ends. If it then
// acts in full, dissipation falls by 2.2 to 3.7 % of the energy.
TEST(ContactEnergy, FrictionReturnsNoMoreThanItsSpringsStore) {
  for (const int elements : {1, 2, 3}) {
    Impact impact;
    impact.scene.addBox({0, 0, 0}, {2, 1, 1}, {elements, 1, 1});
    impact.scene.addBox({0, 0, 1}, {2, 1, 1}, {elements, 1, 1});
    impact.launch(0, {});
    impact.launch(1, {0.01, 0, -0.01});
    EnforcementConfig config;
    config.scheme = Scheme::energy_neutral;
    config.friction = 100;
    SpringBricks bricks(impact.scene, config, 0.1, 0.8, 0.1);
    bricks.velocity = impact.velocity;
    double start = 0, most = 0, fall = 0;
    for (int step = 0; step < 300; ++step) {
      bricks.step();
      if (step == 0)
        start = bricks.energy;
      most = std::max(most, bricks.dissipated_by_friction);
      fall = std::max(fall, most - bricks.dissipated_by_friction);
    }
    EXPECT_EQ(bricks.sums.active, 0) << "the bricks should have parted again";
    EXPECT_LT(fall, remaining_error * 0.022 * start) << elements;
  }
}

TEST(ContactEnergy, ContactThatEndsBeyondAnEdgeReturnsItsEnergy) {
  const double c = std::sqrt(0.75), s = 0.5;
  Impact impact;
  impact.scene.addBrick({2, 1, 1}, {2, 1, 1}, 1, [&](const Vec3& p) {
    return Vec3{c * (p.x - 1), p.y, s * std::fabs(p.x - 1) + p.z - 1};
  });
  impact.scene.addBrick({1, 0.4, 1}, {1, 1, 1}, 1, [&](const Vec3& p) {
    return Vec3{s * (p.x - p.z), 0.3 + p.y, c * (p.x + p.z) + 0.001};
  });
  impact.scene.fix(0);
  impact.launch(0, {});
  impact.launch(1, {0, 0, -0.05});
  EnforcementConfig config;
  config.penalty = 0.01;
  config.max_activation_depth = 0.1; // no sides of the bodies
  SpringBricks bricks(impact.scene, config, 0.1, 0.8, 1);
  bricks.velocity = impact.velocity;
  bricks.step();
  const double start = bricks.energy;
  double worst = 0;
  for (int step = 0; step < 60; ++step) {
    bricks.step();
    worst = std::max(worst, std::fabs(bricks.energy / start - 1));
  }
  EXPECT_EQ(bricks.sums.interactions, 0);
  EXPECT_LT(worst, 2e-3);
}

// The energy at the next half step is k w p^n p^{n+1}/2, and p = P - e.
TEST(ContactEnergy, OffsetMakesUpHalfOfTheMissingWork) {
  const double held = 0.01, missing = 1e-4, gain = 0.1 - offsetAfter(held + missing, held);
  EXPECT_NEAR(0.5 * 3 * 0.5 * 0.2 * gain, missing / 2, 1e-17);
  const double loss = offsetAfter(held - missing, held) - 0.1;
  EXPECT_NEAR(loss, gain, 1e-15);
}

TEST(ContactEnergy, OffsetChangesByATenthAtMostAndNotByRounding) {
  EXPECT_NEAR(offsetAfter(1.0, 0.01), 0.1 - 0.02, 1e-15);
  EXPECT_NEAR(offsetAfter(0.0, 1.0), 0.1 + 0.02, 1e-15);
  EXPECT_EQ(offsetAfter(0.01, 0.01 * (1 + 1e-12)), 0.1);
}

TEST(ContactEnergy, OffsetMakesNoFadingContactDeeperThanItsPenetration) {
  EXPECT_NEAR(offsetAfter(1.0, 0.01, 0.005), 0, 1e-17);
  EXPECT_EQ(offsetAfter(1.0, 0.01, -0.05), -0.05);
  EXPECT_NEAR(offsetAfter(0.0, 1.0, -0.05), -0.05 + 0.02, 1e-15);
  EXPECT_NEAR(offsetAfter(1.0, 0.01, 0.005, 1.0), 0.005 - 0.02, 1e-15);
}

} // namespace
} // namespace brickwall::contact::testing
