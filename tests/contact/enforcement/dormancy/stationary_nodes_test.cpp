// Stationary nodes and faces are skipped by contact, which changes no result.
#include "tests/contact/enforcement/support/edge_run.hpp"
#include "tests/contact/enforcement/support/scene_run.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact::testing {
namespace {

// Three bricks that lie flush, and one that comes and goes, with pauses in which all are
// stationary.
Scene bricks() {
  Scene scene;
  scene.addBox({0, 0, 0}, {2, 1, 1}, {4, 2, 2});
  scene.addBox({2, 0, 0}, {2, 1, 1}, {4, 2, 2});
  scene.addBox({1, 0, 1}, {2, 1, 1}, {4, 2, 2});
  scene.addBox({3.1, 0.1, 1}, {1, 1, 1}, {2, 2, 2});
  return scene;
}
constexpr int num_steps = 24;
Vec3 motionAt(int step) {
  if (step % 6 >= 3)
    return {};
  return {step < 12 ? -0.03 : 0.04, 0, 0.001 * (step % 5)};
}

template <class ViewType>
std::vector<double> listOf(const ViewType& view) {
  return numbersOf(view, view.extent(0));
}

TEST(StationaryNodes, SkippingThemChangesNoBitOfNodeToFaceContact) {
  EnforcementConfig with = config(), without = config();
  without.skip_stationary = false;
  const auto cut = [](int element) { return (element / 16) % sizeOf(MPI_COMM_WORLD); };
  SceneRun a(bricks(), MPI_COMM_WORLD, cut, with), b(bricks(), MPI_COMM_WORLD, cut, without);
  std::int64_t active = 0, idle = 0;
  for (int step = 0; step < num_steps; ++step) {
    for (SceneRun* run : {&a, &b}) {
      run->scene.step();
      run->scene.move(3, motionAt(step));
    }
    EXPECT_EQ(a.step(), b.step()) << step;
    EXPECT_EQ(a.sums.penetrating, b.sums.penetrating) << step;
    EXPECT_EQ(a.sums.interactions, b.sums.interactions) << step;
    EXPECT_EQ(a.sums.deepest, b.sums.deepest) << step;
    EXPECT_EQ(listOf(a.enforcement.status()), listOf(b.enforcement.status())) << step;
    EXPECT_EQ(listOf(a.enforcement.gap()), listOf(b.enforcement.gap())) << step;
    active += a.sums.active > 0;
    idle += a.sums.penetrating == 0;
  }
  EXPECT_GT(active, 3);
  EXPECT_GT(idle, 3);
}

TEST(StationaryNodes, SkippingThemChangesNoBitOfEdgeToEdgeContact) {
  EnforcementConfig with = config(), without = config();
  without.skip_stationary = false;
  EdgeRun a(crossedRidges(0.05), MPI_COMM_SELF, onOneRank, with);
  EdgeRun b(crossedRidges(0.05), MPI_COMM_SELF, onOneRank, without);
  std::int64_t active = 0;
  for (int step = 0; step < num_steps; ++step) {
    const Vec3 motion = {0, 0, step % 6 >= 3 ? 0 : step < 12 ? -0.02 : 0.03};
    a.move(1, motion);
    b.move(1, motion);
    EXPECT_EQ(a.step(), b.step()) << step;
    EXPECT_EQ(a.sums.penetrating, b.sums.penetrating) << step;
    EXPECT_EQ(a.sums.interactions, b.sums.interactions) << step;
    active += a.sums.active > 0;
  }
  EXPECT_GT(active, 3);
}

TEST(StationaryNodes, FlagsMarkStationaryNodesAndFaces) {
  const exec_space space;
  Scene scene = bricks();
  ScenePart part(scene, MPI_COMM_SELF, onOneRank, 0.3);
  SurfaceMotion motion(space, "test", part.surface());
  StationaryNodes still("test", part.surface());
  const auto update = [&] {
    part.update(scene);
    motion.update(space, part.surface());
    still.update(space, part.surface(), motion, {});
    const auto flags = listOf(still.flags().faces);
    return still.flags().is_any ? flags : std::vector<double>(flags.size(), 0.0);
  };
  for (const double flag : update()) // first call
    EXPECT_EQ(flag, 0);
  for (const double flag : update())
    EXPECT_EQ(flag, 1);
  EXPECT_FALSE(still.isUnchanged());
  update();
  EXPECT_TRUE(still.isUnchanged());
  scene.move(3, {1e-300, -1e-17, 1e-3});
  const auto moved = update();
  for (std::size_t face = 0; face < moved.size(); ++face)
    EXPECT_EQ(moved[face], scene.faces[face].body != 3) << face;
  scene.step(); // at rest now, but moving in the last step
  for (const double flag : update())
    EXPECT_EQ(flag, 1);
  EXPECT_FALSE(still.isUnchanged());
  StepTest wider;
  wider.face_tolerance = 1;
  motion.update(space, part.surface());
  still.update(space, part.surface(), motion, wider);
  EXPECT_FALSE(still.isUnchanged());
}

} // namespace
} // namespace brickwall::contact::testing
