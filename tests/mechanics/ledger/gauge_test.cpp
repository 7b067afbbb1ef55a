// The gauges of the ledger against exact solutions: invariants of linear bodies, telescoping work,
// impulses and their moments.
#include "tests/mechanics/support/solver.hpp"

#include <gtest/gtest.h>

namespace brickwall::mechanics {
namespace {

using namespace testing;

constexpr double rounding = 1e-12; // some hundred steps of sums relative to the energy

Block brick(Vec3 origin = {}) {
  return {{4, 3, 2}, {2, 1, 1}, origin};
}

// Arbitrary displacements and velocities excite all modes.
void stir(Solver& solver, double amplitude) {
  const auto anyVector = [=](double x, double y, double z) {
    const auto seed = static_cast<std::uint64_t>(1e3 * x + 1e6 * y + 1e9 * z + 1e12);
    return amplitude * randomVector(seed);
  };
  solver.state.displacement = solver.field([&](const Vec3& x) { return anyVector(x.x, x.y, x.z); });
  solver.state.velocity = solver.field([&](const Vec3& x) { return anyVector(x.z + 3, x.x, x.y); });
}

// Full integration of the linear material is exactly linear in u.
Solver linearSolid() {
  return Solver(world, brick(), {MaterialModel::linear, 1, 1, 0.3}, {}, asIs, ElementKind::full);
}

TEST(ShadowEnergy, OfALinearSolidIsConstantAtConstantSteps) {
  Solver solver = linearSolid();
  stir(solver, 1e-3);
  const double dt = solver.startAt(0.8);
  const double first = solver.ledger.balance().shadow;
  EXPECT_GT(first, 0);
  for (int s = 0; s < 300; ++s) {
    solver.step(dt);
    ASSERT_NEAR(solver.ledger.balance().shadow / first, 1, rounding) << "step " << s;
  }
}

TEST(ShadowEnergy, IsThatOfTheMeanVelocityLessTheSquareOfTheAcceleration) {
  Solver solver = linearSolid();
  stir(solver, 1e-3);
  const double dt = solver.startAt(0.8);
  for (int s = 0; s < 3; ++s) {
    const auto before = toHost(solver.state.velocity);
    Kokkos::View<double* [3], Kokkos::HostSpace> old("old", before.extent(0));
    for (int node = 0; node < solver.blocks.mesh.num_nodes; ++node)
      for (int i = 0; i < 3; ++i)
        old(node, i) = before(node, i);
    solver.step(dt);
    const auto after = toHost(solver.state.velocity);
    const auto mass = toHost(solver.state.mass);
    const auto owned = toHost(solver.blocks.mesh.node_is_owned);
    double sum = 0;
    for (int node = 0; node < solver.blocks.mesh.num_nodes; ++node)
      for (int i = 0; owned(node) && i < 3; ++i) {
        const double mean = 0.5 * (old(node, i) + after(node, i));
        const double acceleration = (after(node, i) - old(node, i)) / dt;
        sum += mass(node) * (0.5 * mean * mean - dt * dt / 8 * acceleration * acceleration);
      }
    sum = allReduce(world, sum, MPI_SUM);
    const EnergyBalance& b = solver.ledger.balance();
    EXPECT_NEAR(sum + b.stored_material + b.stored_hourglass, b.shadow, rounding * b.shadow);
  }
}

// Rounding is no error of the physics, however small the motion is, as in the first steps of a
// smooth pulse.
TEST(EnergyError, OfSmallMotionsIsFarBelowTheUsualLimit) {
  for (double amplitude = 1e-3; amplitude > 1e-22; amplitude *= 0.3) {
    Solver solver = linearSolid();
    stir(solver, amplitude);
    const double dt = solver.startAt(0.8);
    for (int s = 0; s < 20; ++s) {
      solver.step(dt);
      EXPECT_LE(solver.ledger.balance().energy_error, 0.01) << amplitude << ", step " << s;
    }
  }
}

// Forces are the gradient of the energy; the remaining error is that of a nonlinear body, of second
// order in dt.
TEST(StoredEnergy, FollowsItsWorkWithSecondOrder) {
  const auto errorOf = [](double share) {
    Solver solver(world, brick(), {MaterialModel::neo_hookean, 1, 1, 0.3});
    // smooth, so that dt resolves it
    solver.state.velocity = solver.field([](const Vec3& x) {
      return 0.1 * Vec3{std::sin(2 * x.y), std::cos(x.x + x.z), std::sin(1.5 * x.x)};
    });
    const double dt = solver.startAt(share);
    for (double time = 0; time < 3; time += dt)
      solver.step(dt);
    const EnergyBalance& b = solver.ledger.balance();
    EXPECT_GT(b.peak_hourglass, 1e-3 * b.peak_total);
    EXPECT_EQ(b.work_hourglass, -b.stored_hourglass); // zero at the start
    return b.stored_error;
  };
  const double coarse = errorOf(0.8), fine = errorOf(0.2);
  if (rankOf(world) == 0)
    std::printf("  stored_error at chi = .8, .2: %.2g, %.2g\n", coarse, fine);
  EXPECT_LE(coarse, 1e-3);
  EXPECT_GE(std::log2(coarse / fine) / 2, 1.8);
}

TEST(HourglassShare, IsZeroInUniformStrainAndOneInAPureHourglassMode) {
  for (const bool is_hourglass : {false, true}) {
    Solver solver(MPI_COMM_SELF, Block(), {MaterialModel::neo_hookean, 1, 1, 0.3});
    solver.state.displacement = solver.field([&](const Vec3& x) {
      const double mode = (2 * x.x - 1) * (2 * x.y - 1);
      return is_hourglass ? Vec3{0, 0, 1e-3 * mode} : Vec3{1e-3 * x.x, 0, 0};
    });
    solver.start(1e-6); // too short for a visible motion
    const EnergyBalance& b = solver.ledger.balance();
    EXPECT_GT(b.peak_internal, 0);
    EXPECT_NEAR(b.hourglassShare(), is_hourglass ? 1 : 0, 1e-12);
  }
}

// Far from the origin and rotating; loads follow the body; every force with a moment acts; the step
// changes.
TEST(AngularMomentum, ChangesByTheMomentsOfAllImpulses) {
  Solver solver(world, brick({3, -2, 1}), {MaterialModel::neo_hookean, 1, 1, 0.3});
  solver.state.velocity = solver.field([](const Vec3& x) {
    return cross(Vec3{0.02, -0.01, 0.05}, x - Vec3{4, -1.5, 1.5}) + Vec3{0.01, 0, 0};
  });
  PrescribedMotion hinge;
  hinge.nodes = solver.nodesWhere([](const Vec3& x) { return x.x < 3 + 1e-9 && x.y < -2 + 1e-9; });
  hinge.component[2] = false;
  solver.fix({hinge}, {0.001, 0, -0.002}, 0.1);
  Pressure pressure;
  pressure.peak = 0.02;
  pressure.follower = true;
  solver.press(pressure, [](const Vec3& x) { return x.z > 2 - 1e-9; });
  const double stable = solver.stableStep();
  double dt = 0.8 * stable;
  solver.start(dt);
  for (int s = 0; s < 400; ++s) {
    const double next = s == 200 ? 0.3 * stable : dt;
    solver.step(dt, next);
    dt = next;
  }
  const EnergyBalance& b = solver.ledger.balance();
  ASSERT_EQ(b.failures, 0);
  for (const Vec3& moment :
       {b.moment_external, b.moment_gravity, b.moment_reaction, b.moment_damping})
    EXPECT_GT(norm(moment), 0.01 * norm(b.angular_momentum));
  EXPECT_LE(b.angular_momentum_error, 1e-13);
  EXPECT_LE(b.momentum_error, 1e-12);
  EXPECT_LE(b.ledger_residual, 1e-13);
}

// The closed form is x_0 x M g t.
TEST(AngularMomentum, OfFreeFallGrowsWithTheTimeOfTheHalfStep) {
  const Vec3 gravity = {0, 0, -0.1}, centre = {4, -1.5, 1.5};
  Solver solver(world, brick({3, -2, 1}), {MaterialModel::neo_hookean, 1, 1, 0.3}, gravity);
  const double dt = solver.run(0.8, 100);
  const EnergyBalance& b = solver.ledger.balance();
  const double mass = 2;
  const Vec3 exact = (mass * (solver.time + 0.5 * dt)) * cross(centre, gravity);
  EXPECT_LE(norm(b.angular_momentum - exact), rounding * norm(exact));
  EXPECT_LE(b.angular_momentum_error, 1e-13);
}

// A force that the gauge does not include is detected: a couple on 2 of 60 nodes, a small part of R
// sqrt(2 K M).
TEST(AngularMomentum, DetectsAMomentWithoutASource) {
  Solver solver(MPI_COMM_SELF, brick(), {MaterialModel::neo_hookean, 1, 1, 0.3});
  solver.contact = [&] {
    const auto forces = toHost(solver.forces.values);
    forces(0, 3 * contact_force + 1) += 1LL << 30;
    forces(solver.blocks.mesh.num_nodes - 1, 3 * contact_force + 1) -= 1LL << 30;
    Kokkos::deep_copy(solver.forces.values, forces);
    return ContactEnergySums();
  };
  const double dt = solver.startAt(0.8);
  solver.step(dt);
  EXPECT_LE(solver.ledger.balance().momentum_error, 1e-12);
  EXPECT_GT(solver.ledger.balance().angular_momentum_error, 0.05);
}

// A force that the balance does not include acts on one node, for the same time as the loads. Loads
// on two opposite sides have twice the magnitude of those on one, and no resultant.
TEST(Momentum, ErrorIsRelativeToTheLoadsAlsoWhereTheyCancel) {
  const auto balanceOf = [](bool on_both_sides) {
    Solver solver(MPI_COMM_SELF, brick(), {MaterialModel::neo_hookean, 1, 1, 0.3});
    Pressure pressure;
    pressure.peak = 0.02;
    pressure.follower = false;
    solver.press(pressure, [](const Vec3& x) { return x.y < 1e-9; });
    if (on_both_sides)
      solver.press(pressure, [](const Vec3& x) { return x.y > 1 - 1e-9; });
    solver.contact = [&solver] {
      const auto forces = toHost(solver.forces.values);
      forces(0, 3 * contact_force + 2) += 1LL << 30;
      Kokkos::deep_copy(solver.forces.values, forces);
      return ContactEnergySums();
    };
    solver.run(0.8, 20);
    return solver.ledger.balance();
  };
  const EnergyBalance one = balanceOf(false), both = balanceOf(true);
  EXPECT_LT(norm(both.impulse_external), 1e-9 * norm(one.impulse_external));
  const double error = norm(one.impulse_contact) / norm(one.impulse_external);
  EXPECT_NEAR(one.momentum_error, error, 1e-9 * error);
  EXPECT_NEAR(both.momentum_error, 0.5 * error, 1e-9 * error);
}

// A step that is shortened after its kick: the kick is taken back in part, with the same result as
// the shorter kick.
TEST(Correction, OfAKickGivesTheResultOfTheShorterKick) {
  const auto run = [](bool corrects, bool at_start) {
    auto solver = std::make_unique<Solver>(world, brick({3, -2, 1}),
                                           Material{MaterialModel::neo_hookean, 1, 1, 0.3},
                                           Vec3{0, 0, -0.01});
    stir(*solver, 1e-3);
    const double dt = 0.8 * solver->stableStep(), shorter = 0.1 * dt;
    const double before = at_start ? 0 : dt, first = corrects ? dt : shorter;
    if (at_start) {
      solver->start(first);
    } else {
      solver->start(dt);
      drift(solver->space, dt, solver->state);
      solver->evaluateAndKick(0.5 * (dt + first), first);
    }
    if (corrects) {
      const double back = 0.5 * (before + shorter) - 0.5 * (before + dt);
      solver->ledger.bookCorrection(world, back, shorter,
                                    kick(solver->space, solver->blocks.mesh, *solver->boundary,
                                         {solver->time, solver->time + shorter}, back,
                                         solver->forces, solver->state, solver->scales));
    }
    solver->steps(10, shorter);
    return solver;
  };
  for (const bool at_start : {false, true}) {
    const auto whole = run(false, at_start), corrected = run(true, at_start);
    const EnergyBalance &a = whole->ledger.balance(), &b = corrected->ledger.balance();
    EXPECT_NEAR(a.kinetic, b.kinetic, 1e-13 * a.kinetic);
    EXPECT_NEAR(a.total_half, b.total_half, 1e-13 * a.total_half);
    EXPECT_NEAR(a.energy_error, b.energy_error, 1e-12);
    EXPECT_NEAR(a.stored_error, b.stored_error, 1e-12);
    EXPECT_NEAR(a.work[internal_force], b.work[internal_force], 1e-13 * a.peak_total);
    EXPECT_LE(norm(a.momentum - b.momentum), 1e-13 * norm(a.momentum));
    EXPECT_LE(b.momentum_error, 1e-12);
    EXPECT_LE(b.angular_momentum_error, 1e-12);
    EXPECT_LE(b.ledger_residual, 1e-13);
  }
}

TEST(SpeedTest, CountsTheFastNodesOfAllRanks) {
  Solver solver(world, bar(9), {MaterialModel::linear, 1, 1, 0});
  solver.state.velocity = solver.field([](const Vec3& x) {
    return Vec3{1, 0, x.x < 1e-9 ? 0.5 : 0.0};
  });
  solver.start(1e-9);
  EXPECT_EQ(solver.ledger.balance().fast_nodes, 0); // no test requested
  zeroForces(solver.space, solver.forces);
  const auto count = [&](const SpeedTest& test) {
    KickSums sums = kick(solver.space, solver.blocks.mesh, *solver.boundary, {}, 1e-9,
                         solver.forces, solver.state, solver.scales, test);
    allReduce(world, sums);
    return sums.sum[kick_fast_nodes].high;
  };
  EXPECT_EQ(count({{1, 0, 0}, 0.4}), 4); // the four at the end
  EXPECT_EQ(count({{1, 0, 0}, 0.6}), 0);
  EXPECT_EQ(count({{0, 0, 0}, 0.6}), 40);
}

} // namespace
} // namespace brickwall::mechanics
