// The kick of packs of nodes and that of a device against that of single nodes, bit for bit.
#include "mechanics/ledger/sum_limbs.hpp"
#include "mechanics/step/kick_kernel.hpp"
#include "tests/mechanics/support/solver.hpp"

#include <gtest/gtest.h>

namespace brickwall::mechanics::testing {
namespace {

constexpr double dt = 1e-3;

// Forces of each kind that acts at some nodes, and velocities.
void setRandomly(Solver& solver) {
  const auto forces = Kokkos::create_mirror_view(solver.forces.values);
  const auto velocity = Kokkos::create_mirror_view(solver.state.velocity);
  const int columns = static_cast<int>(forces.extent(1));
  for (int node = 0; node < solver.blocks.mesh.num_nodes; ++node) {
    for (int c = 0; c < columns; ++c)
      if (solver.forces.acts[c / 3] && (c < 3 || (node / (2 << (c / 3))) % 3 == 0))
        forces(node, c) = static_cast<std::int64_t>(randomOf(columns * node + c) * 1e12);
    for (int i = 0; i < 3; ++i)
      velocity(node, i) = randomOf(7 + 3 * node + i);
  }
  Kokkos::deep_copy(solver.forces.values, forces);
  Kokkos::deep_copy(solver.state.velocity, velocity);
}

// [node] 1 where contact acts.
View<unsigned char*> flagsOfContact(const Solver& solver) {
  const auto forces = toHost(solver.forces.values);
  const int num_nodes = solver.blocks.mesh.num_nodes;
  const View<unsigned char*> flags("test::flags_of_contact", num_nodes);
  const auto host_flags = Kokkos::create_mirror_view(flags);
  for (int node = 0; node < num_nodes; ++node)
    for (int i = 0; i < 3; ++i)
      if (forces(node, 3 * contact_force + i) != 0)
        host_flags(node) = 1;
  Kokkos::deep_copy(flags, host_flags);
  return flags;
}

template <int kinds>
void compareWithNodes(Solver& solver) {
  setRandomly(solver);
  const HexMesh& mesh = solver.blocks.mesh;
  const View<double* [3]> velocity("test::velocity", mesh.num_nodes);
  const View<double* [3]> before("test::velocity_before", mesh.num_nodes);
  Kokkos::deep_copy(velocity, solver.state.velocity);
  Kokkos::deep_copy(before, solver.state.velocity);
  const SpeedTest test = {{0.1, 0, 0}, 0.7};
  KickNode<kinds> kickNode{mesh.reference_coordinates,
                           solver.state.displacement,
                           velocity,
                           solver.state.mass,
                           mesh.node_is_owned,
                           solver.forces.values,
                           solver.forces.quantum.value,
                           dt,
                           solver.boundary->during({0, dt}),
                           solver.scales,
                           test};
  KickSums expected;
  Kokkos::parallel_reduce("test::kickNodes", rangePolicy(solver.space, mesh.num_nodes), kickNode,
                          PlusReducer<KickSums>(expected));
  solver.space.fence();
  expected.carry();
  KickSums sums = kick(solver.space, mesh, *solver.boundary, {0, dt}, dt, solver.forces,
                       solver.state, solver.scales, test);
  EXPECT_EQ(sums.invalid, 0);
  for (int k = 0; k < KickSums::size(); ++k)
    EXPECT_EQ(sums.data()[k], expected.data()[k]) << "limb " << k;
  const auto by_packs = toHost(solver.state.velocity), by_nodes = toHost(velocity);
  for (int node = 0; node < mesh.num_nodes; ++node)
    for (int i = 0; i < 3; ++i)
      EXPECT_EQ(by_packs(node, i), by_nodes(node, i)) << "node " << node;

  Kokkos::deep_copy(velocity, before);
  kickNode.acts = solver.forces.acts;
  kickNode.may_touch = flagsOfContact(solver);
  kickNode.ahead = {View<double* [3]>("test::ahead", mesh.num_nodes), 0.5 * dt};
  KickSums strided =
      sumStrided<num_kick_terms, true>("test::kickStrided", solver.space, mesh.num_nodes,
                                       KickStrided<kinds>(kickNode, mesh.num_nodes));
  strided.carry();
  for (int k = 0; k < KickSums::size(); ++k)
    EXPECT_EQ(strided.data()[k], expected.data()[k]) << "limb " << k;
  const auto by_stride = toHost(velocity);
  drift(solver.space, 0.5 * dt, solver.state);
  const auto ahead = toHost(kickNode.ahead.displacement);
  const auto drifted = toHost(solver.state.displacement);
  for (int node = 0; node < mesh.num_nodes; ++node)
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(by_stride(node, i), by_packs(node, i)) << "node " << node;
      EXPECT_EQ(ahead(node, i), drifted(node, i)) << "node " << node;
    }
}

Solver makeSolver() {
  const Block block{{5, 4, 3}};
  Solver solver(world, block, steelLike(), {0, 0, -10});
  PrescribedMotion held;
  held.nodes = solver.nodesWhere([](const Vec3& X) { return X.x == 0 && X.y < 0.3; });
  solver.fix({held}, {0, 0, -10});
  return solver;
}

TEST(Kick, InPacksIsThatOfEachNode) {
  Solver solver = makeSolver();
  compareWithNodes<viscous_force>(solver);
}

TEST(Kick, InPacksIsThatOfEachNodeWithViscosity) {
  Solver solver = makeSolver();
  solver.forces = zeroedForces(solver.blocks.mesh, solver.forces.quantum, true);
  compareWithNodes<num_force_kinds>(solver);
}

TEST(Kick, DoesNotReadKindsThatDoNotAct) {
  Solver solver = makeSolver();
  solver.forces.acts[contact_force] = false;
  compareWithNodes<viscous_force>(solver);
}

} // namespace
} // namespace brickwall::mechanics::testing
