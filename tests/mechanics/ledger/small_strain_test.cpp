// Strain that linear materials neglect: (H^T H)/2 of a rotation and of a stretch, of linear
// elements only.
#include "mechanics/ledger/small_strain.hpp"
#include "tests/mechanics/support/solver.hpp"

#include <gtest/gtest.h>

namespace brickwall::mechanics {
namespace {

using namespace testing;

NeglectedStrain leftOut(MaterialModel model, const std::function<Vec3(const Vec3&)>& field) {
  const exec_space space;
  const BlockMesh blocks = makeBlocks(space, world, {bar(3)}, {steelLike(model)}, asIs, slices);
  return neglectedStrain(space, world, blocks.mesh, nodalField(space, blocks.mesh, field));
}

TEST(NeglectedStrain, OfARotationIsHalfItsSquare) {
  const double w = 0.1, c = std::cos(w) - 1, s = std::sin(w);
  const auto turned = leftOut(MaterialModel::linear, [=](const Vec3& x) {
    return Vec3{c * x.x - s * x.y, s * x.x + c * x.y, 0};
  });
  EXPECT_NEAR(turned.strain, 1 - std::cos(w), 1e-15); // w^2/2
  EXPECT_LT(turned.strain, large_neglected_strain);
  const auto spun = leftOut(MaterialModel::linear, [](const Vec3& x) {
    return 0.2 * Vec3{-x.y, x.x, 0};
  });
  EXPECT_NEAR(spun.strain, 0.02, 1e-15);
  EXPECT_GT(spun.strain, large_neglected_strain);
}

TEST(NeglectedStrain, IsThatOfTheElementWithTheLargestStrain) {
  const auto bent = leftOut(MaterialModel::linear, [](const Vec3& x) {
    return Vec3{0, 0, x.x > 0.5 ? x.x : 0.};
  });
  EXPECT_EQ(bent.elem, 1); // u_x = 0 at x = 1/3 and 2/3 at x = 2/3: a slope of 2, then of 1
  EXPECT_NEAR(bent.strain, 2, 1e-14);
}

TEST(NeglectedStrain, IsZeroForNonlinearMaterials) {
  for (const MaterialModel model : {MaterialModel::svk, MaterialModel::neo_hookean})
    EXPECT_EQ(leftOut(model, [](const Vec3& x) { return 0.3 * x; }).strain, 0);
}

} // namespace
} // namespace brickwall::mechanics
