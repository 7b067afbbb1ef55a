// Mass-proportional damping: the decay of central differences with a centred velocity is known in
// closed form. The ledger closes with and without it, and no bit depends on the partition.
#include "tests/mechanics/support/solver.hpp"

#include <gtest/gtest.h>

namespace brickwall::mechanics {
namespace {

using namespace testing;

// v+/v- of a free body over a kick.
double decay(double damping, double dt) {
  const double half = 0.5 * damping * dt;
  return (1 - half) / (1 + half);
}

TEST(MassDamping, SlowsAFreeBodyAsTheClosedForm) {
  Solver solver(world, Block{{3, 2, 1}}, steelLike());
  constexpr double alpha = 0.3;
  constexpr int steps = 200;
  solver.fix({}, {}, alpha);
  const Vec3 before = {0.2, -0.1, 0.05};
  solver.state.velocity = solver.field([&](const Vec3&) { return before; });
  const double dt = solver.run(0.8, steps);
  const double left = decay(alpha, 0.5 * dt) * std::pow(decay(alpha, dt), steps);
  EXPECT_LT(left, 1e-3);
  const EnergyBalance& b = solver.ledger.balance();
  const double mass = 1;
  EXPECT_LE(norm(b.momentum - left * mass * before), 1e-13 * norm(before));
  EXPECT_LE(norm(b.impulse_damping - (left - 1) * mass * before), 1e-13 * norm(before));
  EXPECT_NEAR(b.work_damping, 0.5 * mass * (left * left - 1) * dot(before, before), 1e-14);
  EXPECT_LE(b.ledger_residual, 1e-13);
  EXPECT_LE(b.momentum_error, 1e-13);
  EXPECT_LE(b.energy_error, 1e-13);
}

// One element that breathes along x: relative displacement w with omega^2 = 2 k/m = 4 E/(rho L^2).
// Central differences give w+ (1 + h) - (2 - omega^2 dt^2) w + (1 - h) w- = 0, whose Casoratian w+
// w- - w^2 decays by (1 - h)/(1 + h) per step.
TEST(MassDamping, OfAnOscillatorDecaysAsTheDifferenceEquation) {
  Solver solver(MPI_COMM_SELF, Block(), {MaterialModel::linear, 1, 1, 0});
  constexpr double alpha = 0.1, amplitude = 0.1, dt = 0.5;
  constexpr int steps = 120;
  solver.fix({}, {}, alpha);
  solver.state.displacement = solver.field([&](const Vec3& x) {
    return Vec3{amplitude * (x.x - 0.5), 0, 0};
  });
  const auto ends = solver.nodesWhere([](const Vec3& x) { return x.y < 0.5 && x.z < 0.5; });
  const auto opening = [&] {
    const auto u = toHost(solver.state.displacement);
    return u(ends[1], 0) - u(ends[0], 0);
  };
  std::vector<double> w = {opening()};
  solver.start(dt);
  for (int s = 0; s < steps; ++s) {
    solver.step(dt);
    w.push_back(opening());
    ASSERT_LE(solver.ledger.balance().ledger_residual, 1e-13);
  }
  const double h = 0.5 * alpha * dt, omega_square = 4;
  double expected = -HUGE_VAL, largest = 0;
  for (std::size_t n = 1; n + 1 < w.size(); ++n) {
    expected = ((2 - omega_square * dt * dt) * w[n] - (1 - h) * w[n - 1]) / (1 + h);
    largest = std::max(largest, std::fabs(w[n + 1] - expected));
  }
  EXPECT_LE(largest, 1e-14 * amplitude);
  const auto casoratian = [&](std::size_t n) { return w[n + 1] * w[n - 1] - w[n] * w[n]; };
  const double left = std::pow(decay(alpha, dt), steps - 2);
  EXPECT_LT(left, 0.01);
  EXPECT_NEAR(casoratian(steps - 1), left * casoratian(1), 1e-11 * left * std::fabs(casoratian(1)));
  EXPECT_LE(solver.ledger.balance().energy_error,
            1e-13); // the gauge stays exact for linear springs
  // The gauge's energy at the start is (1 - (omega dt)^2/4) U; each step keeps (1 - h)/(1 + h) of
  // it.
  const double start = 0.75 * 0.5 * amplitude * amplitude;
  EXPECT_NEAR(solver.ledger.balance().dissipated.damping, start, 0.01 * start);
}

// Loads, gravity, prescribed motion and steps of two lengths.
struct Loaded {
  std::vector<std::int64_t> velocity;
  EnergyBalance balance;
  bool never_gained = true; // by damping
};
Loaded loadedBlock(MPI_Comm comm, PulseKind pulse, double mass_damping) {
  const auto bent = [](const Vec3& x) { return x + Vec3{0.05 * std::sin(3 * x.y), 0, 0}; };
  Solver solver(comm, {{4, 3, 2}}, steelLike(), {}, bent);
  solver.driveAndPress(pulse, mass_damping);
  const double stable = solver.stableStep();
  double dt = 0.7 * stable;
  solver.start(dt);
  Loaded result;
  double before = solver.ledger.balance().work_damping;
  for (int s = 0; s < 200; ++s) {
    const double next = s == 100 ? 0.5 * stable : dt;
    solver.step(dt, next);
    dt = next;
    result.never_gained = result.never_gained && solver.ledger.balance().work_damping <= before;
    before = solver.ledger.balance().work_damping;
  }
  result.velocity = globalWords(comm, solver.blocks, solver.state.velocity);
  result.balance = solver.ledger.balance();
  return result;
}

TEST(LoadedBlock, ClosesTheLedgerAndGivesTheSameBitsForAnyPartition) {
  for (const double damping : {0.0, 0.5}) {
    const PulseKind pulse = damping > 0 ? PulseKind::sin_squared : PulseKind::friedlander;
    const Loaded whole = loadedBlock(MPI_COMM_SELF, pulse, damping);
    const Loaded cut = loadedBlock(world, pulse, damping);
    EXPECT_EQ(whole.velocity, cut.velocity);
    EXPECT_EQ(whole.balance.work_damping, cut.balance.work_damping);
    EXPECT_EQ(whole.balance.total_half, cut.balance.total_half);
    EXPECT_EQ(whole.balance.momentum_error, cut.balance.momentum_error);
    const EnergyBalance& b = cut.balance;
    EXPECT_TRUE(cut.never_gained);
    EXPECT_EQ(b.work_damping<-1e-6, damping> 0);
    EXPECT_EQ(norm(b.impulse_damping) > 1e-3, damping > 0);
    EXPECT_GT(norm(b.impulse_external), 1e-3);
    EXPECT_GT(norm(b.impulse_reaction), 1e-3);
    EXPECT_GT(std::fabs(b.work_reaction), 1e-6);
    EXPECT_EQ(norm(b.impulse_contact), 0);
    EXPECT_LE(b.ledger_residual, 1e-13);
    EXPECT_LE(b.momentum_error, 1e-12);
    EXPECT_LE(b.energy_error, 0.02); // O(dt^2) of the load and the change of step
    EXPECT_EQ(b.failures, 0);
  }
}

} // namespace
} // namespace brickwall::mechanics
