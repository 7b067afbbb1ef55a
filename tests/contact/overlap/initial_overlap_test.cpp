// The deepest initial penetration of bodies.
#include "contact/overlap/initial_overlap.hpp"
#include "tests/contact/enforcement/support/scene_run.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact::testing {
namespace {

constexpr double reach = 0.5;

InitialOverlap overlapOf(const Scene& scene, double within = reach) {
  const ScenePart part(scene, MPI_COMM_SELF, onOneRank, within);
  return deepestOverlap(exec_space(), MPI_COMM_SELF, part.surface(), within);
}

// A cube of edge length 0.5 on one corner, its diagonal along the axis `up` from there.
int addOnCorner(Scene& scene, const Vec3& tip, int up) {
  return scene.addBrick({0.5, 0.5, 0.5}, {1, 1, 1}, 1, [&](const Vec3& p) {
    const Vec3 turned = {(p.x - p.y) / std::sqrt(2.0), (p.x + p.y - 2 * p.z) / std::sqrt(6.0),
                         (p.x + p.y + p.z) / std::sqrt(3.0)};
    Vec3 placed;
    for (int d = 0; d < 3; ++d)
      placed[(up + 1 + d) % 3] = tip[(up + 1 + d) % 3] + turned[d];
    return placed;
  });
}

// A plate [0, 2] x [0, 2] x [-thickness, 0] of 2 x 2 faces a side, and a cube whose tip along `up`
// is at `tip`.
Scene cornerAtPlate(double thickness, const Vec3& tip, int up) {
  Scene scene;
  scene.addBox({0, 0, -thickness}, {2, 2, thickness}, {2, 2, 1});
  addOnCorner(scene, tip, up);
  return scene;
}

// A plate [0, 2] x [0, 2] x [-1, 0] and on it a block [0.5, 1.5] x [0.5, 1.5] from z = `height`.
Scene blockAbovePlate(double height) {
  Scene scene;
  scene.addBox({0, 0, -1}, {2, 2, 1}, {2, 2, 1});
  scene.addBox({0.5, 0.5, height}, {1, 1, 1}, {2, 2, 1});
  return scene;
}

// All corners of the block's underside are as deep in the plate as the plate's middle node is in
// the block.
TEST(InitialOverlap, FlatFacesOverlapByTheirDistanceAndTheLowestNodeIsNamed) {
  const Scene scene = blockAbovePlate(-0.0625);
  const InitialOverlap found = overlapOf(scene);
  EXPECT_EQ(found.depth, 0.0625);
  EXPECT_EQ(found.node, scene.nodeAt(0, {1, 1, 0}));
  EXPECT_EQ(found.node_body, 0);
  EXPECT_EQ(found.face_body, 1);
  global_id lowest = INT64_MAX; // of the four faces of the underside around the middle
  for (const Scene::Face& face : scene.faces)
    for (const int node : face.nodes)
      if (node == scene.nodeAt(1, {1, 1, -0.0625}) && face.id % 6 == 4)
        lowest = std::min(lowest, face.id);
  EXPECT_EQ(found.face, lowest);
}

TEST(InitialOverlap, ACornerInAFaceIsAsDeepAsItsTip) {
  const Scene scene = cornerAtPlate(1, {1.3, 0.6, -0.0625}, 2);
  const InitialOverlap found = overlapOf(scene);
  EXPECT_EQ(found.depth, 0.0625);
  EXPECT_EQ(found.node, scene.nodeAt(1, {1.3, 0.6, -0.0625}));
  EXPECT_EQ(found.node_body, 1);
  EXPECT_EQ(found.face, 6 * 1 + 5); // the top of the plate's second element
  EXPECT_EQ(found.face_body, 0);
}

TEST(InitialOverlap, FlushBodiesAndBodiesApartDoNotOverlap) {
  EXPECT_EQ(overlapOf(blockAbovePlate(0)).depth, 0);
  EXPECT_EQ(overlapOf(blockAbovePlate(0)).node, -1);
  EXPECT_EQ(overlapOf(blockAbovePlate(0.0625)).depth, 0);
  EXPECT_EQ(overlapOf(blockAbovePlate(5)).depth, 0); // no candidates at all
}

// Beyond the side of a thin plate a node is behind the planes of top and bottom, and yet outside.
TEST(InitialOverlap, ANodeJustBeyondTheEdgeOfAThinPlateIsOutside) {
  constexpr double thickness = 0.125, beyond = 1e-6;
  for (const double z : {-0.0625, -0.015625, beyond, -thickness - beyond})
    EXPECT_EQ(overlapOf(cornerAtPlate(thickness, {2 + beyond, 1.3, z}, 0)).depth, 0) << z;
}

TEST(InitialOverlap, ANodeJustInsideTheEdgeOfAThinPlateIsBehindItsSide) {
  constexpr double within = 1.0 / 1024;
  const InitialOverlap found = overlapOf(cornerAtPlate(0.125, {2 - within, 1.3, -0.0625}, 0));
  EXPECT_EQ(found.depth, within);
  EXPECT_EQ(found.face % 6, 1); // x = 2
}

// Outside the sharp edge of an overhanging side, behind the plane of the side and above that of the
// top: the edge is closest.
TEST(InitialOverlap, ANodeBeyondASharpEdgeIsOutsideThoughBehindOneOfItsFaces) {
  constexpr double beyond = 1.0 / 1024;
  Scene scene;
  scene.addBrick({2, 1, 1}, {1, 1, 1}, 1, [](const Vec3& p) {
    return Vec3{p.x + p.z - 1, p.y, p.z - 1};
  });
  addOnCorner(scene, {2 + 0.5 * beyond, 0.5, beyond}, 0);
  EXPECT_EQ(overlapOf(scene).depth, 0);
}

// A bar twisted about z, its middle in the origin: its sides are strongly warped.
Scene twistedBar(double twist) {
  Scene scene;
  scene.addBrick({0.5, 1.5, 1.5}, {1, 2, 1}, 1, [&](const Vec3& p) {
    const Vec3 q = p - Vec3{0.25, 0.75, 0.75};
    const double c = std::cos(twist * q.z), s = std::sin(twist * q.z);
    return Vec3{c * q.x - s * q.y, s * q.x + c * q.y, q.z};
  });
  return scene;
}

// Cubes around twisted bars, each separated from its bar by a plane: none is inside, although it
// lies behind some faces.
TEST(InitialOverlap, BodiesWithAPlaneBetweenThemDoNotOverlapHoweverWarped) {
  constexpr double gap = 0.1;
  for (const double twist : {-1.2, -0.6, 0.9, 1.2})
    for (int turn = 0; turn < 16; ++turn)
      for (const double height : {-0.8, -0.3, 0.0, 0.4, 0.8}) {
        Scene scene = twistedBar(twist);
        const double flat = std::sqrt(1 - height * height), angle = std::acos(-1.0) * turn / 8;
        const Vec3 away = {flat * std::cos(angle), flat * std::sin(angle), height};
        double farthest = 0;
        for (const Vec3& x : scene.x_new)
          farthest = std::max(farthest, dot(x, away));
        // the cube's corners are up to sqrt(3)/4 from its middle
        const Vec3 middle = (farthest + 0.25 * std::sqrt(3.0) + gap) * away;
        scene.addBox(middle - Vec3{0.25, 0.25, 0.25}, {0.5, 0.5, 0.5}, {1, 1, 1});
        EXPECT_EQ(overlapOf(scene, 1.5).depth, 0) << twist << " " << turn << " " << height;
      }
}

TEST(InitialOverlap, ANodeInATwistedBarIsFoundWhereverItIs) {
  const Vec3 tips[] = {{0.02, 0.1, 0.05}, {-0.04, 0.3, -0.03}, {0.05, -0.35, 0.02}};
  for (const double twist : {-1.2, 0.9, 1.2})
    for (const Vec3& tip : tips) {
      Scene scene = twistedBar(twist);
      addOnCorner(scene, tip, 0);
      EXPECT_GT(overlapOf(scene, 1.5).depth, 0.04) << twist << " " << tip.y;
    }
}

TEST(InitialOverlap, IsTheSamePairOnAnyRanksAndCut) {
  const int size = sizeOf(MPI_COMM_WORLD);
  Scene heap; // many overlaps of many depths, some of them equal
  for (int b = 0; b < 6; ++b)
    heap.addBox({0.9375 * (b % 2), 0.25 * b, 0.96875 * (b / 2)}, {1, 1, 1}, {3, 3, 3});
  addOnCorner(heap, {0.3, 1.3, 2.8}, 2); // the deepest, of the last nodes
  for (const Scene& scene :
       {heap, blockAbovePlate(-0.0625), blockAbovePlate(0), blockAbovePlate(3)}) {
    const InitialOverlap expected = overlapOf(scene);
    const int num_elems = static_cast<int>(scene.elements.size());
    const auto slabs = [&](int e) { return e * size / num_elems; };
    const ScenePart cuts[2] = {{scene, MPI_COMM_WORLD, scattered, reach},
                               {scene, MPI_COMM_WORLD, slabs, reach}};
    for (const ScenePart& part : cuts) {
      const InitialOverlap found =
          deepestOverlap(exec_space(), MPI_COMM_WORLD, part.surface(), reach);
      EXPECT_EQ(found.depth, expected.depth);
      EXPECT_EQ(found.node, expected.node);
      EXPECT_EQ(found.face, expected.face);
      EXPECT_EQ(found.node_body, expected.node_body);
      EXPECT_EQ(found.face_body, expected.face_body);
    }
  }
  EXPECT_NEAR(overlapOf(heap).depth, 2.9375 - 2.8, 1e-15);
}

} // namespace
} // namespace brickwall::contact::testing
