// Sides of concave bodies and lines of convex edges, for every partition of the elements.
#include "contact/surface/features/feature_edges.hpp"
#include "tests/contact/enforcement/support/scene_run.hpp"

#include <gtest/gtest.h>

#include <map>

namespace brickwall::contact::testing {
namespace {

// A plate of 4 x 4 elements whose top and bottom follow z = height(x, y), |x|, |y| <= 1.
template <class Height>
Scene bentPlate(const Height& height) {
  Scene scene;
  scene.addBrick({2, 2, 0.5}, {4, 4, 1}, 1, [&](const Vec3& p) {
    return Vec3{p.x - 1, p.y - 1, p.z - 0.5 + height(p.x - 1, p.y - 1)};
  });
  return scene;
}
Scene groove(double slope) {
  return bentPlate([=](double x, double) { return slope * std::fabs(x); });
}

Scene pit() {
  return bentPlate([](double x, double y) { return std::fabs(x) + std::fabs(y); });
}

std::map<global_id, int> sidesOf(const Scene& scene, MPI_Comm comm, int stride) {
  const int size = sizeOf(comm);
  const ScenePart part(
      scene, comm, [&](int e) { return e / stride % size; }, 0.1);
  const std::vector<int> sides = findFeatureEdges(comm, part.surface()).face_sides;
  const auto ids = toHost(part.surface().face_ids);
  std::map<global_id, int> by_id;
  for (std::size_t face = 0; face < sides.size(); ++face)
    by_id[ids(face)] = sides[face];
  return by_id;
}

// [face of the top] by the signs of x and y: 2 (x > 0) + (y > 0).
std::vector<std::set<int>> sidesOfTop(const Scene& scene) {
  std::vector<std::set<int>> sides(4);
  const auto by_id = sidesOf(scene, MPI_COMM_SELF, 1);
  for (const Scene::Face& face : scene.faces)
    if (face.id % 6 == 5) {
      const Vec3 middle = 0.5 * (scene.x_new[face.nodes[0]] + scene.x_new[face.nodes[2]]);
      sides[2 * (middle.x > 0) + (middle.y > 0)].insert(by_id.at(face.id));
    }
  return sides;
}

TEST(SurfaceSides, ConvexBodiesHaveOne) {
  Scene scene;
  scene.addBox({0, 0, 0}, {2, 3, 1}, {2, 3, 1});
  for (const auto& [id, side] : sidesOf(scene, MPI_COMM_SELF, 1))
    EXPECT_EQ(side, 0) << id;
}

TEST(SurfaceSides, FlanksOfAGrooveDifferFromAnAngleOfATwentiethOn) {
  for (const double slope : {3.0, 1.0, 0.3, 0.05, 0.0255, 0.0245}) {
    const auto sides = sidesOfTop(groove(slope));
    for (const auto& of_part : sides)
      ASSERT_EQ(of_part.size(), 1u) << slope;
    EXPECT_EQ(sides[0], sides[1]) << slope;
    EXPECT_EQ(sides[2], sides[3]) << slope;
    EXPECT_EQ(sides[0] != sides[2], 2 * std::atan(slope) > 0.05) << slope;
  }
}

TEST(SurfaceSides, AllFlanksOfAPitDiffer) {
  std::set<int> all;
  for (const auto& of_part : sidesOfTop(pit())) {
    ASSERT_EQ(of_part.size(), 1u);
    all.insert(of_part.begin(), of_part.end());
  }
  EXPECT_EQ(all, (std::set<int>{0, 1, 2, 3}));
}

// Of parallel grooves that follow each other, patches that do not meet share a side.
TEST(SurfaceSides, PatchesThatShareNoConcaveNodeMayBeOfOneSide) {
  const Scene scene = bentPlate([](double x, double) { return x * x; }); // edges at -0.5, 0, 0.5
  std::set<int> all;
  for (const auto& of_part : sidesOfTop(scene))
    all.insert(of_part.begin(), of_part.end());
  EXPECT_EQ(all, (std::set<int>{0, 1}));
}

// The dent ends inside the top, so that no closed line of edges parts its faces.
TEST(SurfaceSides, APatchThatMeetsItselfAtADentHasOne) {
  const Scene scene = bentPlate([](double x, double y) { return x == 0 && y == 0.5 ? -0.2 : 0.0; });
  const ScenePart part(
      scene, MPI_COMM_SELF, [](int) { return 0; }, 0.1);
  int bent = 0;
  for (const unsigned char edges : findFeatureEdges(MPI_COMM_SELF, part.surface()).face_edges)
    bent += edges >> 4;
  EXPECT_GT(bent, 0);
  const auto sides = sidesOfTop(scene);
  std::set<int> all;
  for (const auto& of_part : sides)
    all.insert(of_part.begin(), of_part.end());
  EXPECT_EQ(all, std::set<int>{0});
}

TEST(SurfaceSides, AreTheSameForEveryPartition) {
  for (const Scene& scene : {groove(1), groove(0.1), pit()})
    for (const int stride : {1, 3, 8, 16}) {
      const auto expected = sidesOf(scene, MPI_COMM_SELF, 1);
      for (const auto& [id, side] : sidesOf(scene, MPI_COMM_WORLD, stride))
        EXPECT_EQ(side, expected.at(id)) << id;
    }
}

// Concave edges between sides are feature edges with both bits, at any angle.
TEST(SurfaceSides, MeetAtFeatureEdges) {
  for (const double slope : {1.0, 0.05}) {
    const Scene scene = groove(slope);
    const ScenePart part(
        scene, MPI_COMM_SELF, [](int) { return 0; }, 0.1);
    FaceAttributes face;
    int between = 0;
    for (const unsigned char edges : findFeatureEdges(MPI_COMM_SELF, part.surface()).face_edges) {
      face.feature_edges = edges;
      for (int j = 0; j < 4; ++j)
        between += (face.trueEdges() & ~face.edgesOfBody()) >> j & 1;
    }
    EXPECT_EQ(between, 2 * 4) << slope; // the bottom of the groove, from both sides
  }
}

// By edge: 4 times the id of the face that lists it, plus its number there.
std::map<global_id, int> linesOf(const Scene& scene, MPI_Comm comm, int stride) {
  const int size = sizeOf(comm);
  const ScenePart part(
      scene, comm, [&](int e) { return e / stride % size; }, 0.1);
  const auto ids = toHost(part.surface().face_ids);
  std::map<global_id, int> lines;
  for (const FeatureEdge& edge : findFeatureEdges(comm, part.surface()).convex)
    lines[4 * ids(edge.face) + edge.edge] = edge.line;
  return lines;
}

TEST(EdgeLines, ABoxHasTwelveForEveryPartition) {
  Scene scene;
  scene.addBox({0, 0, 0}, {2, 3, 4}, {2, 3, 4});
  const auto expected = linesOf(scene, MPI_COMM_SELF, 1);
  std::map<int, std::vector<global_id>> edges; // by line
  for (const auto& [id, line] : expected)
    edges[line].push_back(id);
  ASSERT_EQ(edges.size(), 12u);
  std::map<std::size_t, int> lengths;
  for (const auto& [line, ids] : edges)
    ++lengths[ids.size()];
  EXPECT_EQ(lengths, (std::map<std::size_t, int>{{2, 4}, {3, 4}, {4, 4}}));
  for (const int stride : {1, 2, 7})
    for (const auto& [id, line] : linesOf(scene, MPI_COMM_WORLD, stride))
      EXPECT_EQ(line, expected.at(id)) << id;
}

} // namespace
} // namespace brickwall::contact::testing
