// Prints element-steps per second of the internal forces alone, and node-steps per second of the
// kick.
#include "mechanics/force/internal_force.hpp"
#include "mechanics/step/central_difference.hpp"
#include "tests/mechanics/support/block_mesh.hpp"

#include <gtest/gtest.h>

#include <cstdio>

namespace brickwall::mechanics {
namespace {

using namespace testing;

std::vector<Block> wallOf(int bricks) {
  std::vector<Block> blocks(bricks);
  for (int b = 0; b < bricks; ++b) {
    blocks[b].elements[0] = 16;
    blocks[b].elements[1] = blocks[b].elements[2] = 8;
    blocks[b].size = {2, 1, 1};
    blocks[b].origin = {2.5 * b, 0, 0};
  }
  return blocks;
}

void measure(const char* name, ElementKind kind, bool distorted, MaterialModel model,
             bool with_energy) {
  const exec_space space;
  const auto place = [&](const Vec3& x) {
    return distorted ? x + Vec3{0.01 * std::sin(9 * x.y), 0.01 * std::sin(7 * x.z), 0} : x;
  };
  BlockMesh blocks = makeBlocks(space, MPI_COMM_SELF, wallOf(24), {steelLike(model, 0.2)}, place);
  const auto u = nodalField(space, blocks.mesh, [](const Vec3& x) {
    return Vec3{1e-3 * std::sin(x.y), 2e-3 * x.x * x.z, 1e-3 * x.y * x.x};
  });
  const Quantum quantum = Quantum::forForceScale(forceScale(space, MPI_COMM_SELF, blocks.mesh));
  InternalForce internal(space, MPI_COMM_SELF, blocks.mesh, kind, quantum, testEnergyScale());
  NodalForces forces = zeroedForces(blocks.mesh, quantum);
  double best = HUGE_VAL;
  for (int repeat = 0; repeat < 7; ++repeat) {
    zeroForces(space, forces);
    const Kokkos::Timer timer;
    const auto result = internal.add(space, u, forces, with_energy);
    best = std::min(best, timer.seconds());
    ASSERT_EQ(result.failure.count, 0);
  }
  std::printf("  %-34s %6.2f M element-steps/s on %d thread(s)\n", name,
              blocks.mesh.num_elems / best * 1e-6, concurrency(space));
}

TEST(ElementSpeed, IsPrinted) {
  measure("box, neo-Hookean", ElementKind::one_point, false, MaterialModel::neo_hookean, false);
  measure("box, neo-Hookean, with energies", ElementKind::one_point, false,
          MaterialModel::neo_hookean, true);
  measure("box, svk", ElementKind::one_point, false, MaterialModel::svk, false);
  measure("box, linear", ElementKind::one_point, false, MaterialModel::linear, false);
  measure("general, neo-Hookean", ElementKind::one_point, true, MaterialModel::neo_hookean, false);
  measure("general, svk", ElementKind::one_point, true, MaterialModel::svk, false);
  measure("full box, neo-Hookean", ElementKind::full, false, MaterialModel::neo_hookean, false);
  measure("full general, neo-Hookean", ElementKind::full, true, MaterialModel::neo_hookean, false);
}

TEST(KickSpeed, IsPrinted) {
  const exec_space space;
  BlockMesh blocks = makeBlocks(space, MPI_COMM_SELF, wallOf(24), {steelLike()});
  NodalState state = stateAtRest(space, MPI_COMM_SELF, blocks);
  const Quantum quantum = Quantum::forForceScale(forceScale(space, MPI_COMM_SELF, blocks.mesh));
  NodalForces forces = zeroedForces(blocks.mesh, quantum);
  Kokkos::deep_copy(Kokkos::subview(forces.values, Kokkos::ALL(), std::make_pair(0, 3)), 123456789);
  const LedgerScales scales = ledgerScales(space, MPI_COMM_SELF, blocks.mesh);
  const BoundaryConditions boundary(space, blocks.mesh.num_nodes, {}, Vec3());
  double best = HUGE_VAL;
  for (int repeat = 0; repeat < 7; ++repeat) {
    const Kokkos::Timer timer;
    kick(space, blocks.mesh, boundary, {}, 1e-9, forces, state, scales);
    best = std::min(best, timer.seconds());
  }
  std::printf("  kick with ledger sums              %6.2f M node-steps/s\n",
              blocks.mesh.num_nodes / best * 1e-6);
}

} // namespace
} // namespace brickwall::mechanics
