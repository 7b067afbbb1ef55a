// Bodies with an initial rotation: rounding of their energy is no error, and energetic bodies are
// judged by the usual limits.
#include "mechanics/ledger/turned_rounding.hpp"
#include "mechanics/loads/initial_conditions.hpp"
#include "tests/mechanics/support/solver.hpp"

#include <gtest/gtest.h>

#include <array>

namespace brickwall::mechanics {
namespace {

using namespace testing;

// (sine, cosine) of 30, 90, 150 and 180 degrees about z.
const std::array<double, 2> turns[] = {
    {0.5, 0.8660254037844387}, {1, 0}, {0.5, -0.8660254037844387}, {1.2246467991473532e-16, -1}};

EnergyBalance run(const std::array<double, 2>& turn, double speed, bool allows,
                  MaterialModel model = MaterialModel::neo_hookean) {
  const Block block{{4, 3, 2}, {2, 1, 1}};
  Solver solver(world, block, {model, 1, 1, 0.2});
  AffineField field;
  field.gradient(0, 0) = field.gradient(1, 1) = turn[1] - 1;
  field.gradient(0, 1) = -turn[0], field.gradient(1, 0) = turn[0];
  const std::vector<unsigned char> all(static_cast<std::size_t>(solver.blocks.mesh.num_elems), 1);
  setInitialField(solver.space, solver.blocks.mesh, solver.blocks.sum, all, field,
                  solver.state.displacement);
  if (speed > 0)
    solver.state.velocity = solver.field([&](const Vec3& x) {
      return Vec3{speed * x.x, -speed * x.y * x.z, 0};
    });
  if (allows)
    raiseNoiseFloorForRotation(solver.space, world, solver.blocks.mesh, solver.state.displacement,
                               solver.scales);
  solver.run(0.7, 200);
  return solver.ledger.balance();
}

TEST(RotatedBody, AtRestHasNoErrorsExceptRounding) {
  bool needs_it = false;
  for (const auto& turn : turns) {
    const EnergyBalance b = run(turn, 0, true), before = run(turn, 0, false);
    EXPECT_LT(b.energy_error, 0.02) << turn[1];
    EXPECT_LT(b.angular_momentum_error, 1e-6) << turn[1];
    EXPECT_FALSE(b.is_above_noise);
    needs_it = needs_it || before.energy_error > 0.1;
  }
  EXPECT_TRUE(needs_it);
}

TEST(RotatedBody, InMotionIsJudgedByTheUsualLimits) {
  for (const double speed : {1e-5, 1e-2}) {
    const EnergyBalance b = run(turns[0], speed, true), before = run(turns[0], speed, false);
    EXPECT_TRUE(b.is_above_noise);
    EXPECT_EQ(b.energy_error, before.energy_error);
    EXPECT_EQ(b.angular_momentum_error, before.angular_momentum_error);
  }
}

// Energies that square a strain have no such rounding: their noise floor is unchanged.
TEST(RotatedBody, OfAnotherMaterialRaisesNoFloor) {
  const exec_space space;
  for (const MaterialModel model : {MaterialModel::svk, MaterialModel::neo_hookean}) {
    const BlockMesh blocks =
        makeBlocks(space, MPI_COMM_SELF, {bar(3)}, {steelLike(model)}, asIs, onOneRank);
    LedgerScales scales = ledgerScales(space, MPI_COMM_SELF, blocks.mesh);
    const double noise = scales.noise, angular_noise = scales.angular_noise;
    View<double* [3]> u("test::u", blocks.mesh.num_nodes);
    raiseNoiseFloorForRotation(space, MPI_COMM_SELF, blocks.mesh, u, scales);
    EXPECT_EQ(scales.noise, noise); // no displacement
    u = nodalField(space, blocks.mesh, [](const Vec3& x) { return -2 * Vec3{x.x, x.y, 0}; });
    raiseNoiseFloorForRotation(space, MPI_COMM_SELF, blocks.mesh, u, scales);
    EXPECT_EQ(scales.noise > noise, model == MaterialModel::neo_hookean);
    EXPECT_EQ(scales.angular_noise > angular_noise, model == MaterialModel::neo_hookean);
  }
}

} // namespace
} // namespace brickwall::mechanics
