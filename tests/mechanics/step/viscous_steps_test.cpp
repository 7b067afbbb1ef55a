// Time steps with bulk viscosity: the stable step against the true one, waves, and the ledger.
#include "mechanics/element/hex8_geometry.hpp"
#include "mechanics/element/symmetric_eigenvalue.hpp"
#include "tests/mechanics/support/solver.hpp"

#include <gtest/gtest.h>

#include <cstdio>

namespace brickwall::mechanics {
namespace {

using namespace testing;

// Matrices of one element, by differences of forces about X + u: K/m (elastic) and C/m (viscous,
// linear term only).
struct Matrices {
  double K[24][24], C[24][24];
};
Matrices matricesOf(BlockMesh& one, ElementKind kind, double b1,
                    const std::function<Vec3(const Vec3&)>& u) {
  const exec_space space;
  const Quantum quantum = Quantum::forForceScale(forceScale(space, MPI_COMM_SELF, one.mesh));
  InternalForce internal(space, MPI_COMM_SELF, one.mesh, kind, quantum, testEnergyScale());
  const Kokkos::HostSpace host;
  const auto mass = Kokkos::create_mirror_view_and_copy(
      host, lumpedMass(space, MPI_COMM_SELF, one.mesh, one.sum));
  // The field with one component of one node changed.
  const auto changed = [&](const std::function<Vec3(const Vec3&)>& field, int k, double by) {
    const auto device = nodalField(space, one.mesh, field);
    const auto values = Kokkos::create_mirror_view_and_copy(host, device);
    values(k / 3, k % 3) += by;
    Kokkos::deep_copy(device, values);
    return device;
  };
  // Accelerations by elastic forces, followed by those by viscous forces.
  const auto accelerations = [&](int k, double du, double v) {
    const NodalForces forces = zeroedForces(one.mesh, quantum, true);
    const auto displacement = changed(u, k, du);
    const auto velocity = changed([](const Vec3&) { return Vec3(); }, k, v);
    EXPECT_EQ(internal.add(space, displacement, velocity, {b1, 0}, forces, false).failure.count, 0);
    const auto values = Kokkos::create_mirror_view_and_copy(host, forces.values);
    std::vector<double> result(48, 0);
    for (int r = 0; r < 24; ++r)
      for (int column = r % 3; column < numForceColumns(true); column += 3)
        result[r + (column < 3 * viscous_force ? 0 : 24)] +=
            quantum.value * static_cast<double>(values(r / 3, column)) / mass(r / 3);
    return result;
  };
  Matrices result;
  constexpr double e = 1e-5;
  for (int k = 0; k < 24; ++k) {
    const auto plus = accelerations(k, e, 0), minus = accelerations(k, -e, 0);
    const auto moving = accelerations(k, 0, 1);
    for (int r = 0; r < 24; ++r) {
      result.K[r][k] = (minus[r] - plus[r]) / (2 * e);
      result.C[r][k] = -moving[24 + r];
    }
  }
  return result;
}

// Largest eigenvalue of dt^2 K/4 + dt C/2, M = I: 1 at the stable step.
double load(const Matrices& m, double dt) {
  double sum[24][24];
  for (int r = 0; r < 24; ++r)
    for (int c = 0; c < 24; ++c)
      sum[r][c] = 0.125 * dt * dt * (m.K[r][c] + m.K[c][r]) + 0.25 * dt * (m.C[r][c] + m.C[c][r]);
  return largestEigenvalue(sum);
}

TEST(ViscousStep, IsExactOnACubeAndSafeOnOthers) {
  const exec_space space;
  for (const ElementKind kind : {ElementKind::one_point, ElementKind::full})
    for (const double poisson : {0.0, 0.2, 0.3, 0.45})
      for (int seed = 0; seed < 6; ++seed) {
        const auto place = [seed](const Vec3& x) { // 0: a cube, 1: a flat box
          const auto at = static_cast<std::uint64_t>(100 * seed + 4 * x.x + 2 * x.y + x.z);
          const Vec3 y = {x.x, x.y, seed == 1 ? 0.2 * x.z : x.z};
          return seed < 2 ? y : y + (0.03 * seed) * randomVector(3 * at);
        };
        BlockMesh one =
            makeBlocks(space, MPI_COMM_SELF, {Block()},
                       {Material{MaterialModel::neo_hookean, 1, 1, poisson}}, place, onOneRank);
        const auto at_rest = [](const Vec3&) { return Vec3(); };
        for (const double b1 : {0.0, 0.06, 0.5}) {
          const double dt = stableTimeStep(space, MPI_COMM_SELF, one.mesh, {{b1, 0}}).dt;
          const double used = load(matricesOf(one, kind, b1, at_rest), dt);
          EXPECT_LE(used, 1 + 1e-6) << "seed " << seed << " nu " << poisson << " b1 " << b1;
          if (seed == 0) {
            EXPECT_NEAR(used, 1, 1e-6);
          }
          EXPECT_GE(used, 0.75); // not too conservative
        }
      }
}

// Compressed and sheared: the matrix of the viscous force follows the present configuration.
TEST(ViscousStep, OfADeformedElementUsesTheMassThatContactLeaves) {
  const exec_space space;
  const auto u = [](const Vec3& x) {
    return Vec3{-0.15 * x.x + 0.1 * x.y, -0.1 * x.y, 0.02 * x.x - 0.15 * x.z};
  };
  BlockMesh one = makeBlocks(space, MPI_COMM_SELF, {Block()}, {steelLike()}, asIs, onOneRank);
  const auto displacement = nodalField(space, one.mesh, u);
  for (const double contact : {0.0, 0.36}) {
    const auto step = [&](const StabilityTerms& load) {
      return stableTimeStep(space, MPI_COMM_SELF, one.mesh, displacement, load).dt;
    };
    const double dt = step({{0.2, 0}, 0, contact});
    const double used = load(matricesOf(one, ElementKind::one_point, 0.2, u), dt);
    EXPECT_LE(used, (1 - contact) * (1 + 1e-6));
    EXPECT_GE(used, 0.9 * (1 - contact));
    EXPECT_LT(dt, 0.9 * step({{}, 0, contact}));
    EXPECT_DOUBLE_EQ(step({{}, 0, contact}), std::sqrt(1 - contact) * step({}));
    // At a rate of compression the quadratic term acts as an increase of the linear one.
    EXPECT_DOUBLE_EQ(step({{0.05, 1.2}, 0.1, contact}), step({{0.05 + 1.44 * 0.1, 0}, 0, contact}));
    EXPECT_EQ(step({{0, 0}, 0.1, contact}), step({{}, 0, contact}));
  }
}

// A free cube with random breathing motion: largest kinetic energy over that at the start.
double growth(double dt, const BulkViscosity& b) {
  Solver solver(MPI_COMM_SELF, Block(), {MaterialModel::linear, 1, 1, 0.2});
  solver.makeViscous(b);
  solver.state.velocity = solver.field([](const Vec3& x) {
    const auto at = static_cast<std::uint64_t>(4 * x.x + 2 * x.y + x.z);
    return 1e-8 * randomVector(3 * at);
  });
  solver.start(dt);
  const double start = solver.ledger.balance().kinetic;
  solver.steps(4000, dt);
  return solver.ledger.balance().peak_kinetic / start;
}
TEST(ViscousStep, IsASharpLimit) {
  const Solver at_rest(MPI_COMM_SELF, Block(), {MaterialModel::linear, 1, 1, 0.2});
  const auto step = [&](double b1) {
    return stableTimeStep(at_rest.space, MPI_COMM_SELF, at_rest.blocks.mesh, {{b1, 0}}).dt;
  };
  EXPECT_LE(growth(0.999 * step(0.06), {0.06, 0}), 10);
  EXPECT_GE(growth(1.01 * step(0.06), {0.06, 0}), 1e3);
  // The factor of one-dimensional waves, sqrt(1 + b1^2) - b1, is not sufficient for a breathing
  // cube.
  EXPECT_GE(growth((std::sqrt(1 + 0.06 * 0.06) - 0.06) * step(0), {0.06, 0}), 1e3);
}

struct Wave {
  double overshoot, error; // of the stress relative to p; L1
  EnergyBalance balance;
};
// Stress -p for x < t in a bar of wave speed 1, chi = 0.9, at t = 0.5.
Wave stepWave(int n, const BulkViscosity& b, double pressure) {
  Solver solver(world, bar(n), {MaterialModel::linear, 1, 1, 0});
  solver.makeViscous(b);
  Pressure load;
  load.peak = pressure;
  load.shape.kind = PulseKind::step;
  load.follower = false;
  solver.press(load, [](const Vec3& x) { return x.x < 1e-9; });
  const double rate = pressure; // of the front over a few elements: v = p, tr D = v/h at most
  const double stable = stableTimeStep(solver.space, world, solver.blocks.mesh, {b, rate}).dt;
  const int steps = static_cast<int>(std::ceil(0.5 / (0.9 * stable)));
  const double dt = 0.5 / steps;
  solver.start(dt);
  solver.steps(steps, dt);
  Wave wave{0, 0, solver.ledger.balance()};
  for (const auto& [elem, stress] : solver.axialStresses()) {
    const double s = -stress / pressure;
    wave.overshoot = std::max(wave.overshoot, s - 1);
    wave.error += std::fabs(s - ((elem + 0.5) / n < 0.5 ? 1 : 0)) / n;
  }
  wave.overshoot = allReduce(world, wave.overshoot, MPI_MAX);
  wave.error = allReduce(world, wave.error, MPI_SUM);
  return wave;
}
TEST(ViscousWave, DampsTheOscillationBehindAStep) {
  const Wave without = stepWave(200, {}, 1e-3), linear = stepWave(200, {0.06, 0}, 1e-3);
  const Wave both = stepWave(200, {0.06, 1.2}, 0.1);
  if (rankOf(world) == 0)
    std::printf("  step pressure, N = 200, chi = 0.9: overshoot %.3f, with b1 = 0.06 %.3f, with "
                "b1 = 0.06, b2 = 1.2 at strain 0.1 %.3f; L1 error %.4f %.4f %.4f\n",
                without.overshoot, linear.overshoot, both.overshoot, without.error, linear.error,
                both.error);
  EXPECT_LE(linear.overshoot, 0.6 * without.overshoot);
  EXPECT_LE(both.overshoot, linear.overshoot);
  EXPECT_LE(linear.error, without.error);
  for (const Wave* wave : {&linear, &both}) {
    const EnergyBalance& b = wave->balance;
    EXPECT_LT(b.work[viscous_force], 0);
    EXPECT_GT(b.dissipated.viscosity, 0);
    EXPECT_LE(b.ledger_residual, 1e-13);
    EXPECT_LE(b.momentum_error, 1e-12);
    // q also pushes sideways; the hourglass modes that it excites are not exactly linear springs
    EXPECT_LE(b.energy_error, 1e-6);
    EXPECT_EQ(b.failures, 0);
  }
  EXPECT_EQ(without.balance.work[viscous_force], 0);
}

struct Finish {
  std::vector<std::int64_t> velocity;
  EnergyBalance balance;
};
Finish hitBlock(MPI_Comm comm, ElementKind kind) {
  const Block block{{5, 3, 4}};
  const auto bent = [](const Vec3& x) { return x + Vec3{0.05 * std::sin(3 * x.y), 0, 0}; };
  Solver solver(comm, block, {MaterialModel::neo_hookean, 1, 1, 0.2}, {}, bent, kind);
  solver.makeViscous({0.06, 1.2});
  solver.state.velocity = solver.field([](const Vec3& x) {
    return Vec3{0.1, 0, x.z > 0.6 ? -0.1 : 0.0};
  });
  solver.run(0.6, 100);
  return {globalWords(comm, solver.blocks, solver.state.velocity), solver.ledger.balance()};
}
TEST(ViscousSteps, GiveTheSameBitsForAnyPartitionAndCloseTheLedger) {
  for (const ElementKind kind : {ElementKind::one_point, ElementKind::full}) {
    const Finish whole = hitBlock(MPI_COMM_SELF, kind), cut = hitBlock(world, kind);
    EXPECT_EQ(whole.velocity, cut.velocity);
    EXPECT_EQ(whole.balance.work[viscous_force], cut.balance.work[viscous_force]);
    const EnergyBalance& b = cut.balance;
    EXPECT_LT(b.work[viscous_force], -0.01 * b.peak_kinetic);
    EXPECT_LE(b.ledger_residual, 1e-13);
    EXPECT_LE(b.momentum_error, 1e-13);
    EXPECT_LE(b.angular_momentum_error, 1e-13);
    EXPECT_LE(b.energy_error, 0.01); // finite strains: O(dt^2)
    EXPECT_EQ(b.failures, 0);
  }
}

} // namespace
} // namespace brickwall::mechanics
