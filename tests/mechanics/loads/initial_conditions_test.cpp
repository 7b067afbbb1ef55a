// Initial velocities and deformations: shared nodes, the field itself, and the energy stored by a
// deformation.
#include "mechanics/loads/initial_conditions.hpp"
#include "tests/mechanics/support/solver.hpp"

#include <gtest/gtest.h>

namespace brickwall::mechanics {
namespace {

using namespace testing;

// A bar of 6 elements of which only the third is chosen.
struct ChosenThird {
  exec_space space;
  BlockMesh blocks;
  std::vector<unsigned char> chosen;
  explicit ChosenThird(MPI_Comm comm) {
    blocks = makeBlocks(space, comm, {bar(6)}, {steelLike()}, asIs,
                        comm == MPI_COMM_SELF ? Partition(onOneRank) : nullptr);
    const auto ids = toHost(blocks.mesh.elem_ids);
    for (int e = 0; e < blocks.mesh.num_elems; ++e)
      chosen.push_back(ids(e) == 2);
  }
  View<double* [3]> set(const AffineField& field) {
    View<double* [3]> target("test::target", blocks.mesh.num_nodes);
    setInitialField(space, blocks.mesh, blocks.sum, chosen, field, target);
    return target;
  }
};

TEST(InitialField, ReachesSharedNodesOfRanksWithoutAChosenElement) {
  ChosenThird scene(world);
  const auto X = toHost(scene.blocks.mesh.reference_coordinates);
  const auto v = toHost(scene.set(rigidVelocity({1, 2, 3})));
  for (int node = 0; node < scene.blocks.mesh.num_nodes; ++node) {
    const bool inside = X(node, 0) > 2.0 / 6 - 1e-9 && X(node, 0) < 3.0 / 6 + 1e-9;
    EXPECT_EQ(v(node, 1), inside ? 2 : 0);
  }
}

TEST(InitialField, OfARotationIsTheCrossProductAndHasTheSameBitsForAnyPartition) {
  const Vec3 velocity = {0.1, -0.2, 0.3}, spin = {0.7, -1.1, 0.4}, center = {0.3, 0.2, -0.1};
  const AffineField field = rigidVelocity(velocity, spin, center);
  for (int k = 0; k < 20; ++k) {
    const Vec3 X = {randomOf(3 * k), randomOf(3 * k + 1), randomOf(3 * k + 2)};
    EXPECT_LE(norm(field.at(X) - (velocity + cross(spin, X - center))), 1e-15);
  }
  ChosenThird cut(world), whole(MPI_COMM_SELF);
  EXPECT_EQ(globalWords(world, cut.blocks, cut.set(field)),
            globalWords(MPI_COMM_SELF, whole.blocks, whole.set(field)));
}

// A block that is initially stretched, sheared and at rest oscillates. Its energy is the stored
// one, which an affine field gives exactly, and the half-step gauge conserves it (exactly for
// linear springs without contact).
TEST(InitialDeformation, IsInTheInitialEnergy) {
  const Block block{{4, 3, 2}};
  Solver solver(world, block, {MaterialModel::linear, 1, 1, 0.3});
  AffineField field;
  field.gradient(0, 0) = 1e-3, field.gradient(1, 0) = 5e-4, field.gradient(2, 2) = -2e-4;
  field.center = {0.5, 0.5, 0.5};
  const std::vector<unsigned char> all(static_cast<std::size_t>(solver.blocks.mesh.num_elems), 1);
  setInitialField(solver.space, solver.blocks.mesh, solver.blocks.sum, all, field,
                  solver.state.displacement);
  double H[3][3];
  for (int k = 0; k < 9; ++k)
    H[k / 3][k % 3] = field.gradient(k / 3, k % 3);
  StressPoint<double> point;
  const Material material{MaterialModel::linear, 1, 1, 0.3};
  linearElastic(H, material.lambda(), material.mu(), true, point);

  const double dt = solver.startAt(0.7);
  EXPECT_NEAR(solver.ledger.balance().stored_material, point.W, 1e-13 * point.W);
  solver.steps(200, dt);
  const EnergyBalance& b = solver.ledger.balance();
  EXPECT_GT(b.peak_kinetic, 0.3 * point.W); // it oscillates
  // 1/8 dt^2 a M a, a constant of the gauge, separates the invariant from U(u^0).
  EXPECT_NEAR(b.total_half, point.W, 0.2 * point.W);
  // Hourglass stiffness rotates with the element: third order in the strain of 1e-3, against
  // energies of second order.
  EXPECT_LE(b.energy_error, 1e-4);
  EXPECT_LE(b.ledger_residual, 1e-13);
  EXPECT_LE(b.momentum_error, 1e-13);
}

} // namespace
} // namespace brickwall::mechanics
