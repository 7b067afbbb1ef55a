// Coulomb friction and contact damping: sticking is an exact spring, slip occurs at mu F_n, and no
// energy is created.
#include "contact/enforcement/law/coulomb_friction.hpp"
#include "tests/contact/enforcement/support/scene_run.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact::testing {
namespace {

constexpr double mu = 0.4;

// A block pressed onto a plate, ready to be dragged.
std::unique_ptr<SceneRun> pressedBlock(const EnforcementConfig& c, double press = 0.02) {
  Scene scene;
  scene.addBox({0, 0, -1}, {4, 4, 1}, {4, 4, 1});
  const int block = scene.addBox({1, 1, -press}, {2, 2, 1}, {2, 2, 1});
  scene.cameBy(block, {0, 0, -press});
  scene.fix(
      block); // so that its area, not its masses, determines the stiffness, which is then uniform
  auto run = alone(scene, c);
  run->step();
  return run;
}
EnforcementConfig rough() {
  EnforcementConfig c = config();
  c.friction = mu;
  return c;
}
// Tangential force on the block along x, over its normal force.
double dragRatio(const SceneRun& run, const std::vector<std::array<std::int64_t, 3>>& force) {
  double drag = 0, normal = 0;
  for (std::size_t i = 0; i < force.size(); ++i)
    if (run.scene.node_body[i] == 1) {
      drag += static_cast<double>(force[i][0]);
      normal += static_cast<double>(force[i][2]);
    }
  return drag / normal;
}

TEST(Friction, SticksAsASpringAndSlipsAtMuTimesTheNormalForce) {
  auto run = pressedBlock(rough());
  const auto drag = [&](double by) {
    run->scene.step();
    run->scene.move(1, {by, 0, 0});
    return dragRatio(*run, run->step());
  };
  // k_t = k and p = .02: a drag d gives t/F = d/.02, if it is below mu.
  EXPECT_NEAR(drag(0.002), -0.1, 1e-12);
  EXPECT_NEAR(drag(0.004), -0.3, 1e-12);
  EXPECT_NEAR(drag(-0.006), 0, 1e-12); // back: no drift
  EXPECT_NEAR(drag(0.05), -mu, 1e-12);
  EXPECT_NEAR(drag(0.05), -mu, 1e-12);
  EXPECT_NEAR(drag(-0.008), 0, 1e-12); // mu p: the spring unloads from the returned force
}

TEST(Friction, StiffnessRatioScalesTheStickingSpring) {
  EnforcementConfig c = rough();
  c.friction_stiffness = 0.25;
  auto run = pressedBlock(c);
  run->scene.step();
  run->scene.move(1, {0.004, 0, 0});
  EXPECT_NEAR(dragRatio(*run, run->step()), -0.05, 1e-12);
}

TEST(Friction, KeepsItsForceOverATransferAndAddsUpToZero) {
  auto run = pressedBlock(rough());
  // The block's nodes cross from face to face of the plate (edges of length 1) in steps that keep
  // them sticking.
  double held = 0;
  for (int step = 0; step < 4; ++step) {
    run->scene.step();
    run->scene.move(1, {0.0015, 0, 0});
    const auto force = run->step();
    held += 0.0015 / 0.02;
    EXPECT_NEAR(dragRatio(*run, force), -held, 1e-9) << step;
    std::int64_t sum[3] = {0, 0, 0};
    for (const auto& f : force)
      for (int d = 0; d < 3; ++d)
        sum[d] += f[d];
    EXPECT_EQ(sum[0], 0);
    EXPECT_EQ(sum[2], 0);
  }
}

TEST(Friction, RotatesWithTheContact) {
  const Vec3 t = rotateToPlane({0.3, 0, 0}, {std::sqrt(0.5), 0, std::sqrt(0.5)});
  EXPECT_NEAR(norm(t), 0.3, 1e-15);
  EXPECT_NEAR(t.x, -t.z, 1e-15);
  EXPECT_GT(t.x, 0);
  EXPECT_EQ(norm(rotateToPlane({0, 0, 1}, {0, 0, 1})), 0);
  EXPECT_EQ(norm(returnMap({3, 4, 0}, 10)), 5);
  EXPECT_DOUBLE_EQ(norm(returnMap({3, 4, 0}, 1)), 1);
  EXPECT_EQ(norm(returnMap({3, 4, 0}, 0)), 0);
}

TEST(Friction, TurnsWithTheBodies) {
  auto run = pressedBlock(rough());
  run->scene.step();
  run->scene.move(1, {0.004, 0, 0});
  run->step();
  const double angle = 0.3; // a step, about the normal
  for (int step = 1; step <= 3; ++step) {
    run->scene.step();
    for (Vec3& x : run->scene.x_new)
      x = {std::cos(angle) * x.x - std::sin(angle) * x.y,
           std::sin(angle) * x.x + std::cos(angle) * x.y, x.z};
    const auto force = run->step();
    double sum[3] = {};
    for (std::size_t i = 0; i < force.size(); ++i)
      if (run->scene.node_body[i] == 1)
        for (int d = 0; d < 3; ++d)
          sum[d] += static_cast<double>(force[i][d]);
    EXPECT_NEAR(sum[0] / sum[2], -0.2 * std::cos(step * angle), 1e-12) << step;
    EXPECT_NEAR(sum[1] / sum[2], -0.2 * std::sin(step * angle), 1e-12) << step;
  }
}

TEST(Friction, TheTurnOfAFaceIsExactForRigidRotationsAboutItsNormal) {
  const Vec3 normal = {0, 0.6, 0.8}, across = {1, 0, 0}, along = cross(normal, across);
  const auto at = [&](double angle, double size) {
    return size * (std::cos(angle) * across + std::sin(angle) * along);
  };
  const Vec3 now[2] = {at(0.9, 2), at(2.1, 3)}, before[2] = {at(0.2, 2), at(1.4, 3)};
  const Vec3 motion[2] = {now[0] - before[0], now[1] - before[1]};
  EXPECT_NEAR(halfTurnOf(now, motion, normal), std::tan(0.35), 1e-15);
  EXPECT_NEAR(norm(turnInPlane(before[0], normal, std::tan(0.35)) - now[0]), 0, 1e-15);
  EXPECT_NEAR(halved(std::tan(0.35)), std::tan(0.175), 1e-16);
}

// The slip is along and across the force by turns, so that a first-order error would add up.
TEST(Friction, ASpringThatTurnsKeepsItsEnergy) {
  const Vec3 normal = {0, 0, 1};
  const double stiffness = 2, theta = 0.01;
  Vec3 force = {1, 0, 0};
  double work = 0, bound = 0;
  const double start = dot(force, force);
  for (int step = 0; step < 1000; ++step) {
    const Vec3 slip = 0.01 * cross(normal, force), last = force;
    const double half_turn = std::tan(0.5 * (step % 2 == 0 ? theta : -theta));
    const Vec3 rotated = turnInPlane(last, normal, half_turn);
    force = trialForce(rotated, stiffness, (step % 2 == 0 ? 1 : -1) * slip, normal, half_turn);
    work += 0.5 * dot(last + force, (step % 2 == 0 ? 1 : -1) * slip);
    bound += 0.125 * theta * theta * (norm(last) + norm(force)) * norm(slip);
  }
  EXPECT_NEAR(work, (start - dot(force, force)) / (2 * stiffness), bound);
  EXPECT_LT(bound, 0.01 * 1000 * 0.5 * theta * 0.01); // of the first-order error
}

// Drags to and fro: the recorded work is that of friction, and the stored energy is returned.
TEST(Friction, RecordsItsWorkAndItsStoredEnergy) {
  auto run = pressedBlock(rough());
  double work = 0, stored = 0;
  const auto drag = [&](double by) {
    run->scene.step();
    run->scene.move(1, {by, 0, 0});
    run->step();
    work += run->sums.terms.sum[friction_work].value(energyScale());
    stored = run->sums.terms.sum[friction_stored].value(energyScale());
  };
  for (const double by : {0.001, 0.002, 0.003, 0.0, 0.0}) // at rest again at the end
    drag(by);
  EXPECT_GT(stored, 0);
  EXPECT_NEAR(-work, stored, 1e-12 * stored); // still sticking: all is stored
  for (const double by : {0.01, 0.01, 0.0, -0.008, 0.0, 0.0})
    drag(by);
  EXPECT_NEAR(stored, 0, 1e-12);
  EXPECT_LT(work, -1e-4); // dissipated by slip
}

// A contact that returns within 100 steps and slides faster than it approaches settles: its penalty
// is at most 0.2, and it is damped by the mean approach over the kick, d+ being that with all
// forces; eq. (41).
TEST(Settling, DampsSlidingContactsThatReturnSoon) {
  EnforcementConfig neutral = rough();
  neutral.scheme = Scheme::energy_neutral;
  neutral.corrections = 30;
  const auto returns = [&](const Vec3& motion, int steps_apart, const EnforcementConfig& c) {
    auto run = pressedBlock(c);
    int node = 0;
    while (run->scene.node_body[node] == 0 || run->of(node).empty())
      ++node;
    const double stiffness = run->of(node)[0].stiffness;
    EXPECT_FALSE(run->of(node)[0].settles);
    run->moveAndStep(1, {0, 0, 0.05});
    for (int i = 1; i < steps_apart; ++i)
      run->moveAndStep(1, {0, 0, 0});
    const auto force = run->moveAndStep(1, motion);
    const Interaction pair = run->of(node)[0];
    const double penalty = pair.settles ? std::min(c.penalty, 0.2) : c.penalty;
    EXPECT_NEAR(pair.stiffness / stiffness, penalty / c.penalty, 1e-14);
    Vec3 relative; // acceleration, of a node of a fixed body against a face of the plate
    const Surface& surface = run->part.surface();
    for (int j = 0; j < 4; ++j) {
      const int corner = run->part.nodes()[toHost(surface.face_to_nodes)(pair.face_index, j)];
      const double per_quantum = quantum().value / run->scene.mass[corner];
      relative -= (pair.weight[j] * per_quantum) * Vec3{static_cast<double>(force[corner][0]),
                                                        static_cast<double>(force[corner][1]),
                                                        static_cast<double>(force[corner][2])};
    }
    const double next_closing = pair.closing - dt * dt * dot(pair.normal, relative);
    const double rate = pair.settles ? 2 * pair.stiffness * dt / std::sqrt(penalty) : 0; // c
    EXPECT_NEAR(pair.damping, rate * 0.5 * (pair.closing + next_closing) / dt,
                1e-3 * pair.first_force);
    return pair.settles;
  };
  const Vec3 slide = {0.051, 0, -0.05}, drop = {0.049, 0, -0.05};
  EXPECT_TRUE(returns(slide, 1, neutral));
  EXPECT_TRUE(returns(slide, 100, neutral));
  EXPECT_FALSE(returns(slide, 101, neutral));
  EXPECT_FALSE(returns(drop, 1, neutral));
  EXPECT_FALSE(returns(slide, 1, rough())); // without the corrections that find F_d
  neutral.penalty = 0.1; // softer than contacts that settle need to be
  EXPECT_TRUE(returns(slide, 1, neutral));
  neutral.friction = 0;
  EXPECT_FALSE(returns(slide, 1, neutral));
}

TEST(ContactDamping, NeverPullsAndOpposesTheMotion) {
  EnforcementConfig c = config();
  c.damping = 0.2;
  auto run = pressedBlock(c);
  const int node = run->scene.nodeAt(1, {2, 2, -0.02});
  const auto normalForce = [&](double rise) {
    run->scene.step();
    run->scene.move(1, {0, 0, rise});
    const auto force = run->step();
    return static_cast<double>(force[node][2]) * quantum().value;
  };
  const Interaction rest = (normalForce(0), run->of(node)[0]);
  EXPECT_EQ(rest.damping, 0);
  const double coefficient = 2 * c.damping * rest.stiffness * dt / std::sqrt(c.penalty);
  const double closing = normalForce(-0.001);
  EXPECT_NEAR(run->of(node)[0].damping, coefficient * 0.001 / dt, 1e-12);
  EXPECT_GT(closing, rest.stiffness * 0.021);
  EXPECT_EQ(normalForce(0.0205), 0); // separates fast: F + F_d = 0, not less
  EXPECT_LT(run->of(node)[0].damping, 0);
}

} // namespace
} // namespace brickwall::contact::testing
