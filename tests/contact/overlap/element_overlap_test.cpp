// Bodies that overlap although no node is inside another body: overlap of elements.
#include "contact/overlap/box_pairs.hpp"
#include "contact/overlap/hex_overlap.hpp"
#include "contact/overlap/initial_overlap.hpp"
#include "tests/contact/enforcement/support/scene_run.hpp"

#include <gtest/gtest.h>

#include <random>

namespace brickwall::contact::testing {
namespace {

constexpr double least = 0.125;

// This rank's elements of the bodies whose boxes overlap others, as a host code lists them.
template <class Cut>
BodyElements meetingElements(const Scene& scene, MPI_Comm comm, const Cut& cut) {
  const ScenePart part(scene, comm, cut, 0);
  const auto bodies = bodiesThatMeet(exec_space(), comm, part.surface(), least);
  std::vector<int> chosen;
  for (std::size_t e = 0; e < scene.elements.size(); ++e)
    if (cut(static_cast<int>(e)) == rankOf(comm) &&
        std::binary_search(bodies.begin(), bodies.end(), scene.node_body[scene.elements[e][0]]))
      chosen.push_back(static_cast<int>(e));
  const View<Hexahedron*> hexahedra("test::hexahedra", chosen.size());
  const View<global_id*> ids("test::ids", chosen.size()), of_bodies("test::bodies", chosen.size());
  const auto host = Kokkos::create_mirror_view(hexahedra);
  const auto host_ids = Kokkos::create_mirror_view(ids);
  const auto host_bodies = Kokkos::create_mirror_view(of_bodies);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const auto& nodes = scene.elements[chosen[i]];
    host_ids(i) = chosen[i];
    host_bodies(i) = scene.node_body[nodes[0]];
    for (int k = 0; k < 24; ++k)
      host(i).corner[k / 3][k % 3] = scene.x_new[nodes[k / 3]][k % 3];
  }
  Kokkos::deep_copy(hexahedra, host);
  Kokkos::deep_copy(ids, host_ids);
  Kokkos::deep_copy(of_bodies, host_bodies);
  BodyElements elements;
  elements.count = static_cast<int>(chosen.size());
  elements.hexahedra = hexahedra;
  elements.ids = ids;
  elements.bodies = of_bodies;
  return elements;
}

ElementOverlap elementOverlapOf(const Scene& scene) {
  return deepestElementOverlap(exec_space(), MPI_COMM_SELF,
                               meetingElements(scene, MPI_COMM_SELF, onOneRank), least);
}

double nodeDepthIn(const Scene& scene) {
  const ScenePart part(scene, MPI_COMM_SELF, onOneRank, 0.5);
  return deepestOverlap(exec_space(), MPI_COMM_SELF, part.surface(), 0.5).depth;
}

Scene twoBoxes(const Vec3& corner_a, const Vec3& size_a, const std::array<int, 3>& n_a,
               const Vec3& corner_b, const Vec3& size_b, const std::array<int, 3>& n_b) {
  Scene scene;
  scene.addBox(corner_a, size_a, n_a);
  scene.addBox(corner_b, size_b, n_b);
  return scene;
}

// Bars along x and y; the second one's underside is `depth` below the top of the first.
Scene crossingBars(double depth, int elements) {
  return twoBoxes({-2, -0.5, 0}, {4, 1, 1}, {elements, 1, 1}, {-0.5, -2, 1 - depth}, {1, 4, 1},
                  {1, elements, 1});
}

TEST(ElementOverlap, CrossingBarsStandInEachOtherWithoutANodeInside) {
  const Scene scene = crossingBars(0.75, 1);
  EXPECT_EQ(nodeDepthIn(scene), 0);
  const ElementOverlap found = elementOverlapOf(scene);
  EXPECT_EQ(found.depth, 0.75);
  EXPECT_EQ(found.element, 0);
  EXPECT_EQ(found.other, 1);
  EXPECT_EQ(found.body, 0);
  EXPECT_EQ(found.other_body, 1);
  EXPECT_EQ(found.centre.x, 0);
  EXPECT_EQ(found.centre.y, 0);
  EXPECT_EQ(found.centre.z, 0.5);
}

TEST(ElementOverlap, FlushBarsWhoseNodesLieOnEachOthersSidesStandInEachOther) {
  const Scene in_line =
      twoBoxes({0, 0, 0}, {2, 1, 1}, {1, 1, 1}, {1.25, 0, 0}, {2, 1, 1}, {1, 1, 1});
  EXPECT_EQ(nodeDepthIn(in_line), 0);
  EXPECT_EQ(elementOverlapOf(in_line).depth, 0.75);
  const Scene beside =
      twoBoxes({0, 0, 0}, {2, 1, 1}, {2, 1, 1}, {0.5, 0.75, 0}, {2, 1, 1}, {2, 1, 1});
  EXPECT_EQ(nodeDepthIn(beside), 0);
  EXPECT_EQ(elementOverlapOf(beside).depth, 0.25);
  const Scene through =
      twoBoxes({0, 0, 0}, {9, 9, 1}, {1, 1, 1}, {6.25, 0, -5}, {0.5, 9, 10}, {1, 1, 1});
  EXPECT_EQ(nodeDepthIn(through), 0);
  EXPECT_EQ(elementOverlapOf(through).depth, 2.75); // the shortest way out
  const Scene same_place =
      twoBoxes({0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {0, 0, 0}, {1, 1, 1}, {1, 1, 1});
  EXPECT_EQ(nodeDepthIn(same_place), 0);
  EXPECT_EQ(elementOverlapOf(same_place).depth, 1);
}

TEST(ElementOverlap, ABodyDeepInAnotherIsFound) {
  const Scene scene =
      twoBoxes({0, 0, 0}, {6, 6, 6}, {6, 6, 6}, {2.25, 2.25, 2.25}, {1, 1, 1}, {1, 1, 1});
  EXPECT_EQ(nodeDepthIn(scene), 0); // deeper than the search of nodes and faces reaches
  const ElementOverlap found = elementOverlapOf(scene);
  EXPECT_EQ(found.depth, 0.75);
  EXPECT_EQ(found.element, 2 + 6 * (2 + 6 * 2));
}

TEST(ElementOverlap, BodiesThatTouchOrStandApartOrOverlapNoMoreThanAllowedDoNotOverlap) {
  for (const double depth : {-2.0, -0.0625, 0.0, 1e-9, 0.125})
    for (const int elements : {1, 4})
      EXPECT_EQ(elementOverlapOf(crossingBars(depth, elements)).depth, 0) << depth;
  EXPECT_EQ(elementOverlapOf(crossingBars(0.1875, 4)).depth, 0.1875);
  Scene bond; // flush bricks, half overlapping as in a wall
  for (int course = 0; course < 3; ++course)
    for (int i = 0; i < 3; ++i)
      bond.addBox({2.0 * i + course % 2, 0, 0.7 * course}, {2, 1, 0.7}, {3, 2, 2});
  EXPECT_EQ(elementOverlapOf(bond).depth, 0);
}

// Their boxes overlap deeply: only axes across pairs of edges show that they are separate.
TEST(ElementOverlap, BarsThatPassEachOtherAslantDoNotOverlap) {
  for (const double gap : {0.0, 0.0625, -0.0625, -0.25}) {
    Scene scene;
    const double s = std::sqrt(0.5);
    // Square bars standing on an edge, one along x, the other above it along y; their edges meet at
    // z = s.
    scene.addBrick({8, 1, 1}, {3, 1, 1}, 1, [&](const Vec3& p) {
      return Vec3{p.x - 4, s * (p.y - p.z), s * (p.y + p.z) - s};
    });
    scene.addBrick({8, 1, 1}, {3, 1, 1}, 1, [&](const Vec3& p) {
      return Vec3{s * (p.y - p.z), p.x - 4, s * (p.y + p.z) + s + gap};
    });
    EXPECT_NEAR(elementOverlapOf(scene).depth, gap < -least ? -gap : 0, 1e-15) << gap;
  }
}

// Matching warped sides: the hulls of the elements overlap, the elements do not.
TEST(ElementOverlap, WarpedSidesThatFitEachOtherDoNotOverlap) {
  const auto warped = [](double shift) {
    Scene scene;
    for (int b = 0; b < 2; ++b)
      scene.addBrick({1, 1, 1}, {1, 1, 1}, 1, [&](const Vec3& p) {
        return Vec3{p.x, p.y, p.z + b * (1 - shift) + 0.75 * p.x * p.y};
      });
    return scene;
  };
  const auto hexOf = [](const Scene& scene, int element) {
    Hexahedron hex;
    for (int i = 0; i < 8; ++i)
      hex.corner[i] = scene.x_new[scene.elements[element][i]];
    return hex;
  };
  const Scene fitting = warped(0);
  EXPECT_GT(overlapDepth(hexOf(fitting, 0), hexOf(fitting, 1), 0), 2 * least);
  EXPECT_EQ(elementOverlapOf(fitting).depth, 0);
  EXPECT_GT(elementOverlapOf(warped(0.25)).depth, 2 * least);
}

TEST(ElementOverlap, NoOtherAxisShowsLessOverlap) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&](double size) {
    const double x = uniform(random), y = uniform(random), z = uniform(random);
    return Vec3{size * x, size * y, size * z};
  };
  int deep = 0;
  for (int pair = 0; pair < 200; ++pair) {
    Hexahedron hexes[2];
    const Vec3 shift = vector(1.2);
    const double distortion = pair % 4 == 0 ? 0 : 0.2;
    for (int h = 0; h < 2; ++h)
      for (int i = 0; i < 8; ++i) {
        const Vec3 corner = {i % 4 == 1 || i % 4 == 2 ? 1.0 : 0.0, i % 4 >= 2 ? 1.0 : 0.0,
                             i >= 4 ? 1.0 : 0.0};
        hexes[h].corner[i] = corner + (h == 0 ? Vec3() : shift) + vector(distortion);
      }
    const double depth = overlapDepth(hexes[0], hexes[1], 0);
    const double other_way = overlapDepth(hexes[1], hexes[0], 0);
    deep += depth > 0.1;
    if (depth > 0)
      EXPECT_NEAR(depth, other_way, 1e-14);
    else
      EXPECT_LE(other_way, 0);
    if (depth <= 0)
      continue;
    for (int axis = 0; axis < 20000; ++axis) {
      const Vec3 direction = vector(1);
      const double length = norm(direction);
      ASSERT_GE(hexahedron::overlapAlong(hexes[0], hexes[1], (1 / length) * direction),
                depth - 1e-12)
          << pair;
    }
  }
  EXPECT_GT(deep, 40);
}

TEST(ElementOverlap, IsTheSameOnAnyRanksAndCut) {
  const int size = sizeOf(MPI_COMM_WORLD);
  Scene heap; // bars in all directions, all of equal depth
  for (int b = 0; b < 6; ++b) {
    heap.addBox({-2, 3.0 * b - 0.5, 0}, {4, 1, 1}, {4, 1, 1});
    heap.addBox({-0.5, 3.0 * b - 2, 0.25}, {1, 4, 1}, {1, 4, 1});
  }
  for (const Scene& scene : {heap, crossingBars(0.75, 4), crossingBars(0, 3)}) {
    const ElementOverlap expected = elementOverlapOf(scene);
    const int num_elems = static_cast<int>(scene.elements.size());
    const auto slabs = [&](int e) { return e * size / num_elems; };
    for (const BodyElements& elements : {meetingElements(scene, MPI_COMM_WORLD, scattered),
                                         meetingElements(scene, MPI_COMM_WORLD, slabs)}) {
      const ElementOverlap found =
          deepestElementOverlap(exec_space(), MPI_COMM_WORLD, elements, least);
      EXPECT_EQ(found.depth, expected.depth);
      EXPECT_EQ(found.element, expected.element);
      EXPECT_EQ(found.other, expected.other);
      EXPECT_EQ(found.body, expected.body);
      EXPECT_EQ(found.other_body, expected.other_body);
      EXPECT_EQ(found.centre.x, expected.centre.x);
      EXPECT_EQ(found.centre.y, expected.centre.y);
      EXPECT_EQ(found.centre.z, expected.centre.z);
    }
  }
}

TEST(BodiesThatMeet, AreThoseWhoseBoxesOverlapByMoreThanAsked) {
  const int size = sizeOf(MPI_COMM_WORLD);
  Scene scene;
  scene.addBox({0, 0, 0}, {2, 2, 2}, {4, 1, 1});
  scene.addBox({2 - 0.25, 0, 0}, {2, 2, 2}, {4, 1, 1}); // overlaps the first
  scene.addBox({0, 2 - 0.0625, 0}, {2, 2, 2}, {4, 1, 1}); // barely overlaps it
  scene.addBox({0, 0, 10}, {2, 2, 2}, {4, 1, 1});
  scene.addBox({0.5, 0.5, 11 - 0.03}, {1, 1, 0.06},
               {4, 1, 1}); // thinner than the limit, inside the last
  const ScenePart part(
      scene, MPI_COMM_WORLD, [&](int e) { return e % size; }, 0);
  const auto found = bodiesThatMeet(exec_space(), MPI_COMM_WORLD, part.surface(), least);
  // Four elements per body, distributed cyclically: ranks beyond the fourth have none.
  std::vector<global_id> expected;
  for (const global_id body : {0, 1, 3, 4})
    for (int e = 0; e < static_cast<int>(scene.elements.size()); ++e)
      if (e / 4 == body && e % size == rankOf(MPI_COMM_WORLD)) {
        expected.push_back(body);
        break;
      }
  std::vector<global_id> listed;
  for (const global_id body : found)
    if (std::binary_search(expected.begin(), expected.end(), body))
      listed.push_back(body);
  EXPECT_EQ(listed, expected);
  EXPECT_FALSE(std::binary_search(found.begin(), found.end(), global_id(2)));
}

} // namespace
} // namespace brickwall::contact::testing
