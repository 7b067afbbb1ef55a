// The energy gauges are as exact for linear bodies where steps change in length as at constant
// steps. Contact makes up for a change itself (contact/theory.md, section 7).
#include "tests/mechanics/support/solver.hpp"

#include <gtest/gtest.h>

namespace brickwall::mechanics {
namespace {

using namespace testing;

// A linear solid that moves in all its modes. Every node is on a spring of stiffness k to its
// reference position, entered in the ledger as contact.
struct Springs {
  Solver solver;
  double k;
  Kokkos::View<double* [3], Kokkos::HostSpace> last;
  bool has_last = false;

  explicit Springs(double stiffness)
      : solver(world, {{4, 3, 2}, {2, 1, 1}}, {MaterialModel::linear, 1, 1, 0.3}, {}, asIs,
               ElementKind::full),
        k(stiffness), last("last", solver.blocks.mesh.num_nodes) {
    solver.state.velocity = solver.field([](const Vec3& x) {
      const auto seed = static_cast<std::uint64_t>(1e3 * x.x + 1e6 * x.y + 1e9 * x.z + 1e12);
      return 1e-3 * randomVector(seed);
    });
    if (k > 0)
      solver.contact = [this] { return pull(); };
  }
  ContactEnergySums pull() {
    ContactEnergySums sums;
    const auto owned = toHost(solver.blocks.mesh.node_is_owned);
    const auto u = toHost(solver.state.displacement);
    const auto forces = toHost(solver.forces.values);
    for (int node = 0; node < solver.blocks.mesh.num_nodes; ++node)
      for (int i = 0; i < 3; ++i) {
        forces(node, 3 * contact_force + i) =
            roundToFixed(-k * u(node, i) * solver.forces.quantum.inverse);
        if (owned(node) && has_last)
          sums.add(contact_stored_half, 0.5 * k * last(node, i) * u(node, i), solver.scales.energy);
        last(node, i) = u(node, i);
      }
    Kokkos::deep_copy(solver.forces.values, forces);
    has_last = true;
    return sums;
  }
  // 200 steps, of which the 50th, 100th and 150th change the length of the step if it `changes`.
  const EnergyBalance& run(bool changes) {
    const double shares[4] = {0.5, 0.2, 0.6, 0.35}, stable = solver.stableStep();
    double dt = shares[0] * stable;
    solver.start(dt);
    for (int s = 0; s < 200; ++s) {
      const double next = changes ? shares[s / 50] * stable : dt;
      solver.step(dt, next);
      dt = next;
    }
    return solver.ledger.balance();
  }
};

TEST(ChangedStep, ConservesTheEnergyOfALinearSolid) {
  for (const bool changes : {false, true}) {
    Springs none(0);
    const EnergyBalance& b = none.run(changes);
    EXPECT_LE(b.energy_error, 1e-12);
    EXPECT_LE(b.stored_error, 1e-12);
    EXPECT_EQ(b.contact_error, 0);
    EXPECT_GT(std::fabs(b.work[internal_force]), 1e-3 * b.peak_total);
  }
}

TEST(ChangedStep, ConservesTheEnergyOfContactSprings) {
  Springs springs(0.01);
  const EnergyBalance& b = springs.run(false);
  EXPECT_GT(b.stored_contact, 1e-3 * b.peak_total);
  EXPECT_LE(b.energy_error, 1e-9); // forces are rounded to 2^-54 of a strain of one
  EXPECT_LE(b.contact_error, 1e-9);
  EXPECT_LE(b.stored_error, 1e-9);
}

// A missing tenth of the energy is detected.
TEST(ChangedStep, HidesNoMissingEnergy) {
  Springs springs(0.01);
  double peak = 0;
  springs.solver.contact = [&] {
    ContactEnergySums sums = springs.pull(), told;
    const double stored = sums.sum[contact_stored_half].value(springs.solver.scales.energy);
    peak = std::max(peak, allReduce(world, stored, MPI_SUM));
    told.add(contact_stored_half, 0.9 * stored, springs.solver.scales.energy);
    return told;
  };
  const EnergyBalance& b = springs.run(false);
  EXPECT_NEAR(b.contact_error * b.peak_total, 0.1 * peak, 1e-6 * peak);
}

// The drift is shortened after its kick, which is corrected accordingly.
TEST(ChangedStep, ByACorrectionConservesTheEnergy) {
  Springs none(0);
  Solver& solver = none.solver;
  const double dt = solver.run(0.5, 20);
  const double cut = 0.3 * dt, dt_kick = 0.5 * (cut - dt);
  solver.ledger.bookCorrection(world, dt_kick, cut,
                               kick(solver.space, solver.blocks.mesh, *solver.boundary,
                                    {solver.time, solver.time + cut}, dt_kick, solver.forces,
                                    solver.state, solver.scales));
  solver.steps(20, cut);
  EXPECT_LE(solver.ledger.balance().energy_error, 1e-12);
  EXPECT_LE(solver.ledger.balance().stored_error, 1e-12);
}

} // namespace
} // namespace brickwall::mechanics
