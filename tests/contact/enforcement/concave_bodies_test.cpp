// Contact of a node with several sides of a body, and of an edge with several edges of a body.
#include "contact/surface/features/feature_edges.hpp"
#include "tests/contact/enforcement/support/edge_run.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact::testing {
namespace {

// A groove z = slope |x| along y in the top of body 0, and a wedge, body 1, whose lower edge is at
// (0, y, -depth).
Scene wedgeInGroove(double slope, double depth) {
  Scene scene;
  scene.addBrick({2, 2, 0.5}, {4, 2, 1}, 1, [&](const Vec3& p) {
    return Vec3{p.x - 1, p.y - 1, p.z - 0.5 + slope * std::fabs(p.x - 1)};
  });
  scene.addBrick({0.4, 0.8, 0.6}, {2, 2, 1}, 1, [&](const Vec3& p) {
    const double x = p.x - 0.2;
    return Vec3{x, p.y - 0.4, p.z + (slope + 1) * std::fabs(x) * (1 - p.z / 0.6) - depth};
  });
  const ScenePart part(
      scene, MPI_COMM_SELF, [](int) { return 0; }, 0.1);
  const std::vector<int> sides = findFeatureEdges(MPI_COMM_SELF, part.surface()).face_sides;
  for (std::size_t face = 0; face < scene.faces.size(); ++face)
    scene.faces[face].body = sideOfBody(scene.faces[face].body, sides[face]);
  return scene;
}

// The tip is held by both flanks, with forces that cancel along x, whatever the angle.
TEST(ConcaveBodies, ATipInAGrooveIsHeldByBothFlanks) {
  for (const double slope : {2.0, 1.0, 0.5, 0.3, 0.1}) {
    const Scene scene = wedgeInGroove(slope, -0.002);
    SceneRun run(scene, MPI_COMM_WORLD, [](int e) { return e % sizeOf(MPI_COMM_WORLD); });
    run.step();
    run.moveAndStep(1, {0, 0, -0.003});
    run.moveAndStep(1, {0, 0, -0.003});
    const int tip = run.scene.nodeAt(1, {0, 0, -0.004});
    ASSERT_GE(tip, 0);
    const auto contacts = run.of(tip);
    const int num_contacts = allReduce(MPI_COMM_WORLD, static_cast<int>(contacts.size()), MPI_SUM);
    ASSERT_EQ(num_contacts, 2) << slope;
    if (contacts.size() == 2) {
      EXPECT_NE(contacts[0].side, contacts[1].side);
      EXPECT_EQ(bodyOfSide(contacts[0].side), 0);
      EXPECT_EQ(bodyOfSide(contacts[1].side), 0);
      const double cosine = 1 / std::hypot(1, slope);
      for (const Interaction& contact : contacts)
        EXPECT_NEAR(contact.depth, 0.004 * cosine, 1e-12) << slope;
      EXPECT_NEAR(contacts[0].normal[0], -contacts[1].normal[0], 1e-12);
      EXPECT_GT(contacts[0].force, 0);
      EXPECT_NEAR(contacts[0].force / contacts[1].force, 1, 1e-9) << slope;
    }
  }
}

// Two cubes of one element, face on face and turned by `angle` about their common axis.
Scene turnedCubes(double angle) {
  Scene scene;
  scene.addBox({-0.5, -0.5, -1}, {1, 1, 1}, {1, 1, 1});
  const double c = std::cos(angle), s = std::sin(angle);
  scene.addBrick({1, 1, 1}, {1, 1, 1}, 1, [&](const Vec3& p) {
    const double x = p.x - 0.5, y = p.y - 0.5;
    return Vec3{c * x - s * y, s * x + c * y, p.z + 0.001};
  });
  return scene;
}

// No node lies over the other cube: each of four edges of either one cuts off a corner, where it
// crosses two edges.
TEST(EdgeContact, CubesThatAreTurnedAgainstEachOtherAreHeldWhereEdgesCutOffCorners) {
  for (const double angle : {0.1, 0.2, 0.5, M_PI / 4, 1.3}) {
    EdgeRun run(turnedCubes(angle), MPI_COMM_WORLD, onOneRank);
    run.step();
    EXPECT_EQ(run.sums.interactions, 0) << angle;
    run.move(1, {0, 0, -0.011});
    const auto force = run.step();
    EXPECT_EQ(run.sums.active, 8) << angle;
    EXPECT_NEAR(run.sums.deepest, 0.01, 1e-14) << angle;
    for (std::size_t node = 0; node < force.size(); ++node)
      if (run.scene.x_new[node].z < 0 && run.scene.node_body[node] == 1) {
        EXPECT_GT(force[node][2], 0) << angle;
      }
  }
}

} // namespace
} // namespace brickwall::contact::testing
