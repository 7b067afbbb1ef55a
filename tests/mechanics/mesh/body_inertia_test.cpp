// Nodal masses with the inertia of each body: against moments of the trilinear bodies by another
// quadrature, against closed forms, and on any number of ranks; the stable step with them.
#include "mechanics/mesh/body_inertia.hpp"
#include "mechanics/stability/largest_frequency.hpp"
#include "tests/mechanics/support/block_mesh.hpp"

#include <gtest/gtest.h>

namespace {

using namespace brickwall;
using namespace brickwall::mechanics;
using namespace brickwall::mechanics::testing;

// Mass, first and second moments about a point.
struct Inertia {
  double mass = 0;
  Vec3 first;
  Mat3 second;
  void add(double m, const Vec3& x) {
    mass += m;
    first += m * x;
    for (int k = 0; k < 9; ++k)
      second(k / 3, k % 3) += m * x[k / 3] * x[k % 3];
  }
};

// By the 4x4x4 Gauss rule and shape functions, in contrast to the code's 3x3x3 and modes.
Inertia ofTheBody(const HexMesh& mesh, const Vec3& origin) {
  const double points[4] = {-0.86113631159405258, -0.33998104358485626, 0.33998104358485626,
                            0.86113631159405258};
  const double weights[4] = {0.34785484513745386, 0.65214515486254614, 0.65214515486254614,
                             0.34785484513745386};
  const int corner[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                            {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
  Inertia inertia;
  for (int elem = 0; elem < mesh.num_elems; ++elem)
    for (int p = 0; p < 64; ++p) {
      const int at[3] = {p % 4, p / 4 % 4, p / 16};
      Vec3 x;
      Mat3 jacobian;
      for (int c = 0; c < 8; ++c) {
        const Vec3 X = rowOf(mesh.reference_coordinates, mesh.elem_to_nodes(elem, c)) - origin;
        double factor[3];
        for (int k = 0; k < 3; ++k)
          factor[k] = 0.5 * (1 + corner[c][k] * points[at[k]]);
        x += factor[0] * factor[1] * factor[2] * X;
        for (int j = 0; j < 3; ++j)
          for (int k = 0; k < 3; ++k)
            jacobian(j, k) += 0.5 * corner[c][k] * factor[(k + 1) % 3] * factor[(k + 2) % 3] * X[j];
      }
      const double density = mesh.materials(mesh.elem_block(elem)).density;
      inertia.add(
          density * weights[at[0]] * weights[at[1]] * weights[at[2]] * determinant(jacobian), x);
    }
  return inertia;
}

struct Masses {
  View<double*> lumped, mass, least_shares;
};
Masses massesOf(MPI_Comm comm, BlockMesh& blocks) {
  const exec_space space;
  const auto lumped = lumpedMass(space, comm, blocks.mesh, blocks.sum);
  const BodyMass found = massWithInertia(space, comm, blocks.mesh, lumped);
  return {lumped, found.mass, found.least_shares};
}
Inertia ofTheNodes(const HexMesh& mesh, const View<double*>& mass, const Vec3& origin) {
  Inertia inertia;
  for (int node = 0; node < mesh.num_nodes; ++node)
    inertia.add(mass(node), rowOf(mesh.reference_coordinates, node) - origin);
  return inertia;
}
double traceOfExcess(const Inertia& a, const Inertia& b) {
  return std::fabs(a.second(0, 0) + a.second(1, 1) + a.second(2, 2) - b.second(0, 0) -
                   b.second(1, 1) - b.second(2, 2));
}
double leastShare(const Masses& masses) {
  double least = HUGE_VAL;
  for (std::size_t node = 0; node < masses.mass.extent(0); ++node)
    least = minOf(least, masses.mass(node) / masses.lumped(node));
  return least;
}

constexpr Vec3 away = {31, -17, 8};
Vec3 turnedAndSheared(const Vec3& x) {
  // A rotation by 120 degrees about (1, 1, 1) and one by the 3-4-5 triangle, after a shear.
  const Vec3 sheared = {x.x + 0.5 * x.y + 0.3 * x.z, x.y + 0.6 * x.z, 0.7 * x.z};
  return away +
         Vec3{0.6 * sheared.z - 0.8 * sheared.x, 0.8 * sheared.z + 0.6 * sheared.x, sheared.y};
}
Placement distorted(double size, const Placement& then = asIs) {
  return [=](const Vec3& x) {
    const auto seed = static_cast<std::uint64_t>(1e4 * (x.x + 10 * x.y + 100 * x.z) + 0.5);
    return then(x + size * randomVector(3 * seed));
  };
}
// Elements of 1, 3, 5, ... along each edge.
Placement graded(const Placement& then = asIs) {
  return [=](const Vec3& x) { return then(Vec3{x.x * x.x, x.y * x.y, x.z * x.z}); };
}

BlockMesh brick(const std::array<int, 3>& n, const Placement& place = asIs) {
  Block block;
  std::copy(n.begin(), n.end(), block.elements);
  block.size = {1.0 * n[0], 1.0 * n[1], 1.0 * n[2]};
  return makeBlocks(exec_space(), MPI_COMM_SELF, {block}, {{MaterialModel::linear, 2.5, 1, 0.3}},
                    place, onOneRank);
}

class BodyInertia : public ::testing::Test {
protected:
  void SetUp() override {
    if (!host_accessible)
      GTEST_SKIP() << "reads Views on the host";
  }
};

// Coordinates of magnitude 36 are known to 4e-15, which is 1e-14 of the bodies' radii of gyration.
TEST_F(BodyInertia, IsExactOnMeshesOfThreeElementsOrMoreThroughTheThickness) {
  for (const std::array<int, 3>& n :
       {std::array<int, 3>{3, 3, 3}, {8, 4, 4}, {5, 4, 3}, {16, 3, 9}})
    for (const Placement& place : {Placement(asIs), Placement(turnedAndSheared), distorted(0.1),
                                   distorted(0.25, turnedAndSheared)}) {
      BlockMesh blocks = brick(n, place);
      const Masses masses = massesOf(MPI_COMM_SELF, blocks);
      const Vec3 origin = rowOf(blocks.mesh.reference_coordinates, 0);
      const Inertia expected = ofTheBody(blocks.mesh, origin);
      const Inertia found = ofTheNodes(blocks.mesh, masses.mass, origin);
      const double second = expected.second(0, 0) + expected.second(1, 1) + expected.second(2, 2);
      constexpr double rounding = 5e-13; // of the test's own sums over up to 432 x 64 points
      EXPECT_NEAR(found.mass, expected.mass, rounding * expected.mass);
      EXPECT_LE(norm(found.first - expected.first), rounding * std::sqrt(expected.mass * second));
      for (int k = 0; k < 9; ++k)
        EXPECT_NEAR(found.second(k / 3, k % 3), expected.second(k / 3, k % 3), rounding * second);
      EXPECT_GT(leastShare(masses), 0.35); // no bound was needed
    }
}

// Elements of up to 31 times the length of others; least masses are 0.34 of row sums.
TEST_F(BodyInertia, IsExactOnGradedMeshes) {
  for (const std::array<int, 3>& n :
       {std::array<int, 3>{3, 3, 3}, {8, 4, 4}, {5, 4, 3}, {16, 8, 8}})
    for (const Placement& place : {graded(), graded(turnedAndSheared)}) {
      BlockMesh blocks = brick(n, place);
      const Masses masses = massesOf(MPI_COMM_SELF, blocks);
      const Inertia expected = ofTheBody(blocks.mesh, away);
      const Inertia found = ofTheNodes(blocks.mesh, masses.mass, away);
      const double second = expected.second(0, 0) + expected.second(1, 1) + expected.second(2, 2);
      EXPECT_NEAR(found.mass, expected.mass, 1e-12 * expected.mass);
      for (int k = 0; k < 9; ++k)
        EXPECT_NEAR(found.second(k / 3, k % 3), expected.second(k / 3, k % 3), 1e-12 * second);
      EXPECT_GT(leastShare(masses), 0.33);
    }
}

// Two elements are enough where the mesh is regular.
TEST_F(BodyInertia, IsExactOnRegularMeshesOfTwoElements) {
  for (const std::array<int, 3>& n : {std::array<int, 3>{2, 2, 2}, {4, 2, 2}, {20, 2, 2}}) {
    BlockMesh blocks = brick(n, turnedAndSheared);
    const Masses masses = massesOf(MPI_COMM_SELF, blocks);
    const Inertia expected = ofTheBody(blocks.mesh, away);
    const Inertia found = ofTheNodes(blocks.mesh, masses.mass, away);
    for (int k = 0; k < 9; ++k)
      EXPECT_NEAR(found.second(k / 3, k % 3), expected.second(k / 3, k % 3),
                  1e-13 *
                      norm({expected.second(0, 0), expected.second(1, 1), expected.second(2, 2)}));
    EXPECT_GE(leastShare(masses), 0.49);
  }
}

// Mass and inertia of two elements in a row determine the three masses of a symmetric bar, those
// of Simpson's rule. The second moments across the bar cannot be changed.
TEST_F(BodyInertia, OfTwoElementsInARowHasSimpsonsWeights) {
  for (const Placement& place : {Placement(asIs), Placement(turnedAndSheared)}) {
    BlockMesh blocks = brick({2, 1, 1}, place);
    const Masses masses = massesOf(MPI_COMM_SELF, blocks);
    const double mass = ofTheNodes(blocks.mesh, masses.lumped, {}).mass;
    for (int node = 0; node < 12; ++node)
      EXPECT_NEAR(masses.mass(node), mass / 24 * (node % 3 == 1 ? 4 : 1), 1e-13 * mass);
  }
}

TEST_F(BodyInertia, OfOneElementLeavesTheMassesEqual) {
  for (const Placement& place : {Placement(asIs), Placement(turnedAndSheared)}) {
    BlockMesh blocks = brick({1, 1, 1}, place);
    const Masses masses = massesOf(MPI_COMM_SELF, blocks);
    for (int node = 0; node < 8; ++node)
      EXPECT_NEAR(masses.mass(node), masses.lumped(node), 1e-13 * masses.lumped(node));
  }
}

// A plate of one layer has exact second moments in its plane, whichever way it is turned.
TEST_F(BodyInertia, OfAPlateOfOneLayerIsExactInItsPlane) {
  for (const Placement& place : {Placement(asIs), Placement(turnedAndSheared)}) {
    BlockMesh plate = brick({6, 5, 1}, place), straight = brick({6, 5, 1});
    const Masses masses = massesOf(MPI_COMM_SELF, plate);
    const Inertia found = ofTheNodes(straight.mesh, masses.mass, {3, 2.5, 0.5});
    const double mass = 2.5 * 30 * (place(Vec3{1, 1, 1}).x == 1 ? 1 : 0.7);
    EXPECT_NEAR(found.mass, mass, 1e-12 * mass);
    EXPECT_NEAR(found.second(0, 0), mass * 36 / 12, 1e-12 * mass);
    EXPECT_NEAR(found.second(1, 1), mass * 25 / 12, 1e-12 * mass);
    EXPECT_NEAR(found.second(2, 2), mass / 4, 1e-12 * mass); // three times that of the body
    EXPECT_NEAR(found.second(0, 1), 0, 1e-12 * mass);
  }
}

// Distorted bodies of one or two layers: masses stay positive, with exact sum and centre.
TEST_F(BodyInertia, KeepsMassesPositiveWhereTheInertiaIsOutOfReach) {
  for (const std::array<int, 3>& n : {std::array<int, 3>{1, 1, 1}, {2, 2, 2}, {6, 6, 1}, {9, 1, 2}})
    for (const double size : {1e-6, 0.01, 0.1, 0.25}) {
      BlockMesh blocks = brick(n, distorted(size, turnedAndSheared));
      const Masses masses = massesOf(MPI_COMM_SELF, blocks);
      const Inertia expected = ofTheBody(blocks.mesh, away);
      const Inertia found = ofTheNodes(blocks.mesh, masses.mass, away);
      EXPECT_NEAR(found.mass, expected.mass, 1e-12 * expected.mass);
      EXPECT_LE(norm(found.first - expected.first), 1e-11 * expected.mass);
      EXPECT_GE(leastShare(masses), least_mass_share);
      if (n[2] == 2 && n[1] == 2) { // most of the excess is gone
        const Inertia before = ofTheNodes(blocks.mesh, masses.lumped, away);
        EXPECT_LE(traceOfExcess(found, expected), 0.2 * traceOfExcess(before, expected));
      }
    }
}

std::vector<Block> someBlocks() {
  return {{{3, 3, 3}, {1, 1, 1}, {0, 0, 0}, 0},
          {{2, 4, 5}, {2, 1, 1}, {3, 0, 0}, 1},
          {{5, 1, 1}, {5, 1, 1}, {0, 4, 0}, 0}};
}

TEST_F(BodyInertia, HasTheSameBitsOnAnyNumberOfRanks) {
  const std::vector<Material> materials = {steelLike(), {MaterialModel::linear, 7, 1, 0.2}};
  BlockMesh whole =
      makeBlocks(exec_space(), MPI_COMM_SELF, someBlocks(), materials, distorted(0.05), onOneRank);
  const auto expected = globalWords(MPI_COMM_SELF, whole, massesOf(MPI_COMM_SELF, whole).mass);
  for (const Partition& partition :
       {Partition(nullptr), Partition(onOneRank), Partition(slices), Partition(scattered)}) {
    BlockMesh cut =
        makeBlocks(exec_space(), world, someBlocks(), materials, distorted(0.05), partition);
    EXPECT_EQ(globalWords(world, cut, massesOf(world, cut).mass), expected);
  }
}

// The bound of the elements with the share of their mass that is left: a bound of the bodies, and
// within a factor of two of it.
TEST_F(BodyInertia, HasASafeElementBound) {
  const exec_space space;
  for (const std::array<int, 3>& n : {std::array<int, 3>{2, 2, 2}, {4, 2, 2}, {5, 4, 3}, {8, 4, 4}})
    for (const Placement& place : {Placement(asIs), distorted(0.2)})
      for (const ElementKind kind : {ElementKind::one_point, ElementKind::full}) {
        BlockMesh blocks = brick(n, place);
        const Masses masses = massesOf(MPI_COMM_SELF, blocks);
        StabilityTerms terms;
        terms.mass_shares = masses.least_shares;
        EXPECT_EQ(masses.least_shares(0), leastShare(masses));
        const double bound = stableTimeStep(space, MPI_COMM_SELF, blocks.mesh, terms).dt;
        const auto at_rest = nodalField(space, blocks.mesh, [](const Vec3&) { return Vec3{}; });
        EXPECT_NEAR(stableTimeStep(space, MPI_COMM_SELF, blocks.mesh, at_rest, terms).dt, bound,
                    1e-9 * bound);
        const LargestFrequency found =
            largestFrequency(space, MPI_COMM_SELF, blocks.mesh, blocks.shared, masses.mass,
                             findBodyTypes(space, MPI_COMM_SELF, blocks.mesh), kind, bound);
        const double limit = 2 / std::sqrt(found.ritz);
        EXPECT_LE(bound, limit);
        if (kind == ElementKind::one_point) {
          EXPECT_GE(bound, 0.5 * limit);
        }
      }
}

} // namespace
