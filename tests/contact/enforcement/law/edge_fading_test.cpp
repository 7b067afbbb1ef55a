// Contact beyond true edges: the fading force is the gradient of its energy, and findFeatureEdges()
// finds true edges.
#include "contact/enforcement/law/edge_fading.hpp"
#include "contact/surface/features/feature_edges.hpp"
#include "tests/contact/enforcement/support/scene_run.hpp"

#include <gtest/gtest.h>

#include <random>

namespace brickwall::contact::testing {
namespace {

constexpr double stiffness = 3, offset = 0.02;

FadeRegion allEdges(const Quad& face) {
  FadeRegion reach;
  reach.mask = 15;
  reach.edge_tolerance = 0.2;
  reach.measure(face);
  return reach;
}

// U = k w p^2/2 of a node at `node` on the face, p = P - offset.
double energyOf(const Quad& face, const Vec3& node, const FadeRegion& reach) {
  const FacePoint point = project(face, node);
  EXPECT_TRUE(reach.covers(point, reach.lateral_tolerance));
  const double w = fadeWeightAt(reach, 0, point.xi, -point.gap).value *
                   fadeWeightAt(reach, 1, point.eta, -point.gap).value;
  const double p = -point.gap - offset;
  return 0.5 * stiffness * w * p * p;
}

TEST(FadingForce, IsTheGradientOfTheFadingEnergy) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 200; ++trial) {
    Quad face{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}};
    for (Vec3& x : face.corner)
      x += 0.15 * Vec3{uniform(random), uniform(random), uniform(random)};
    // above the edge xi = 1, above the corner, and inside
    const double xi = trial % 3 == 2 ? 0.5 : 1.05 + 0.1 * std::fabs(uniform(random));
    const double eta =
        trial % 3 == 0 ? 0.7 * uniform(random) : -1.05 - 0.1 * std::fabs(uniform(random));
    Vec3 node;
    const double N[4] = {0.25 * (1 - xi) * (1 - eta), 0.25 * (1 + xi) * (1 - eta),
                         0.25 * (1 + xi) * (1 + eta), 0.25 * (1 - xi) * (1 + eta)};
    for (int j = 0; j < 4; ++j)
      node += N[j] * face.corner[j];
    node.z -= trial % 2 ? 0.05 : 0.15; // the fade length is the least one, or grows with the depth
    const FacePoint point = project(face, node);
    ASSERT_TRUE(point.has_parameters);
    const double p = -point.gap - offset;
    // Half-lengths of the face are constants here; they change with strains only.
    const FadeRegion reach = allEdges(face);
    const LateralForce lateral =
        lateralForce(face, point.xi, point.eta, point.normal, -point.gap, reach, stiffness, p);
    const Vec3 on_node =
        stiffness * p * (lateral.fade_weight + lateral.along_normal) * point.normal +
        lateral.on_node;
    constexpr double step = 1e-5; // central differences: 1e-10 of third derivatives of order 1e3
    const auto slope = [&](Vec3& x, int d) {
      const double kept = x[d];
      x[d] = kept + step;
      const double up = energyOf(face, node, reach);
      x[d] = kept - step;
      const double down = energyOf(face, node, reach);
      x[d] = kept;
      return (up - down) / (2 * step);
    };
    for (int d = 0; d < 3; ++d)
      EXPECT_NEAR(on_node[d], -slope(node, d), 2e-7) << trial;
    for (int j = 0; j < 4; ++j)
      for (int d = 0; d < 3; ++d)
        EXPECT_NEAR(-point.weight[j] * on_node[d] + lateral.on_corner[j] * point.normal[d],
                    -slope(face.corner[j], d), 2e-7)
            << trial << ' ' << j;
  }
}

TEST(FadeWeight, IsOneOnTheFaceAndZeroAtTheEndOfTheFadeLength) {
  FadeRegion reach;
  reach.mask = 2 + 8; // xi = 1 and xi = -1
  EXPECT_EQ(fadeWeightAt(reach, 0, 1.02, 0).value, 1);
  EXPECT_EQ(fadeWeightAt(reach, 0, -1.02, 0).slope, 0);
  EXPECT_NEAR(fadeWeightAt(reach, 0, -1.06, 0).value, 0.5, 1e-12);
  EXPECT_NEAR(fadeWeightAt(reach, 0, 1.1, 0).value, 0, 1e-12);
  EXPECT_EQ(fadeWeightAt(reach, 1, 1.1, 0).value, 1);
  EXPECT_NEAR(fadeWeightAt(reach, 0, 1.22, 0.1).value, 0.5, 1e-12); // over four times the depth
}

// Both ends of the bend, where the length is that of the formula without it, and a slope by central
// differences, which are exact for parabolas.
// Along one edge the extrapolated change is that of this edge. Beyond a corner it stays about that
// of the edge whose end is near, also where fading beyond the other one has just begun.
TEST(FadeWeight, ChangesUntilTheNearestEndAlsoBeyondACorner) {
  const Quad face{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}};
  const FadeRegion region = allEdges(face);
  const double depth = 0.01;
  const FadeWeight none = fadeWeightAt(region, 0, 0.5, depth);
  for (const double beyond : {0.02, 0.1, 0.15}) {
    const FadeWeight far = fadeWeightAt(region, 0, region.start() + beyond, depth);
    ASSERT_GT(far.value, 0);
    EXPECT_EQ(changeToZero(far, none), std::fabs(far.slope) * far.remaining);
    for (const double begun : {1e-9, 1e-6, 1e-3}) {
      const FadeWeight near = fadeWeightAt(region, 1, region.start() + begun, depth);
      EXPECT_GE(changeToZero(far, near), 0.99 * changeToZero(far, none)) << beyond << " " << begun;
      EXPECT_EQ(changeToZero(far, near), changeToZero(near, far));
    }
  }
}

TEST(FadeLength, IsBentToItsLargestValueWithAContinuousSlope) {
  const double least = 0.08, most = 1, step = 1e-3;
  EXPECT_EQ(FadeLength::at(0.01, least, most).value, least);
  EXPECT_EQ(FadeLength::at(0.01, least, most).slope, 0);
  EXPECT_EQ(FadeLength::at(0.3, least, most).value, 0.3);
  EXPECT_EQ(FadeLength::at(0.3, least, most).slope, 1);
  for (const double end : {0.5, 1.5})
    for (const double side : {-1e-9, 1e-9}) {
      const FadeLength length = FadeLength::at(end + side, least, most);
      EXPECT_NEAR(length.value, minOf(end, most), 2e-9);
      EXPECT_NEAR(length.slope, end < most ? 1 : 0, 2e-9);
    }
  for (double x = 0.55; x < 1.5; x += 0.1)
    EXPECT_NEAR((FadeLength::at(x + step, least, most).value -
                 FadeLength::at(x - step, least, most).value) /
                    (2 * step),
                FadeLength::at(x, least, most).slope, 1e-12);
}

// The edges of boxes, for every partition: the 12 edges of a 2 x 3 x 1 box have 4 (2 + 3 + 1)
// segments.
TEST(FeatureEdges, FindsTheTwelveEdgesOfABoxForEveryPartition) {
  Scene scene;
  scene.addBox({0, 0, 0}, {2, 3, 1}, {2, 3, 1});
  const int size = sizeOf(MPI_COMM_WORLD);
  const ScenePart part(
      scene, MPI_COMM_WORLD, [&](int e) { return e % size; }, 0.1);
  const FeatureEdges edges = findFeatureEdges(MPI_COMM_WORLD, part.surface());
  EXPECT_EQ(allReduce(MPI_COMM_WORLD, static_cast<int>(edges.convex.size()), MPI_SUM), 24);
  int marks = 0;
  for (const unsigned char mask : edges.face_edges)
    for (int j = 0; j < 4; ++j)
      marks += mask >> j & 1;
  EXPECT_EQ(allReduce(MPI_COMM_WORLD, marks, MPI_SUM), 48); // each from both sides
  for (const unsigned char mask : edges.face_edges)
    EXPECT_EQ(mask >> 4, 0); // flat sides
  for (const FeatureEdge& edge : edges.convex) {
    EXPECT_EQ(edge.cosine, 0);
    EXPECT_EQ(edge.sine, 1);
    for (const double width : edge.width)
      EXPECT_EQ(width, 1);
  }
  // Of an edge of n segments, 2 (n - 1) ends continue: 4 (2 (2 - 1) + 2 (3 - 1)).
  int going_on = 0;
  for (const FeatureEdge& edge : edges.convex)
    going_on += (edge.goes_on & 1) + (edge.goes_on >> 1);
  EXPECT_EQ(allReduce(MPI_COMM_WORLD, going_on, MPI_SUM), 24);
}

TEST(FeatureEdges, FindsBentEdgesOnASmoothBodyForEveryPartition) {
  Scene scene; // a plate bent to an arc: face angles of 0.2, except at its rim
  scene.addBrick({4, 1, 1}, {8, 1, 1}, 1, [](const Vec3& p) {
    const double angle = 0.4 * p.x, radius = 5 + p.z;
    return Vec3{radius * std::sin(angle), p.y, radius * std::cos(angle)};
  });
  const int size = sizeOf(MPI_COMM_WORLD);
  const ScenePart part(
      scene, MPI_COMM_WORLD, [&](int e) { return e % size; }, 0.1);
  const FeatureEdges edges = findFeatureEdges(MPI_COMM_WORLD, part.surface());
  // along both sides, and the two ends
  EXPECT_EQ(allReduce(MPI_COMM_WORLD, static_cast<int>(edges.convex.size()), MPI_SUM), 4 * 8 + 8);
  int bent = 0;
  for (const unsigned char mask : edges.face_edges)
    for (int j = 4; j < 8; ++j)
      bent += mask >> j & 1;
  // on top and below, from both sides; the flat sides of the plate have none
  EXPECT_EQ(allReduce(MPI_COMM_WORLD, bent, MPI_SUM), 2 * 7 * 2);
}

// Two blocks of one body side by side at different heights: the inner edge of the step is true but
// not convex.
TEST(FeatureEdges, ReentrantEdgesAreTrueButNotConvex) {
  Scene scene;
  scene.addBrick({2, 1, 1}, {2, 1, 1}, 1, [](const Vec3& p) {
    // an L: the second half is bent down
    return p.x > 1.5 ? Vec3{1 + p.z - 1, p.y, -1 * (p.x - 1)} : p;
  });
  const ScenePart part(
      scene, MPI_COMM_SELF, [](int) { return 0; }, 0.1);
  const FeatureEdges edges = findFeatureEdges(MPI_COMM_SELF, part.surface());
  int marks = 0;
  for (const unsigned char mask : edges.face_edges)
    for (int j = 0; j < 4; ++j)
      marks += mask >> j & 1;
  EXPECT_GT(marks, 2 * static_cast<int>(edges.convex.size()));
}

} // namespace
} // namespace brickwall::contact::testing
