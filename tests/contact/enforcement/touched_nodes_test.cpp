// The nodes that contacts act on are listed once each, and no other node is read.
#include "contact/enforcement/selection/touched_nodes.hpp"
#include "tests/contact/enforcement/support/edge_run.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace brickwall::contact::testing {
namespace {

// A small brick on the middle of a large one: 602 surface nodes below, 8 above.
Scene smallOnLarge() {
  Scene scene;
  scene.addBox({0, 0, 0}, {10, 10, 10}, {10, 10, 10});
  scene.addBox({4.1, 4.2, 10.02}, {0.7, 0.7, 0.7}, {1, 1, 1});
  return scene;
}
// Moves down, rests, slides, and leaves.
Vec3 slideAt(int step) {
  return {step >= 6 && step < 9 ? 0.03 : 0.0, 0, step < 3 ? -0.02 : step >= 9 ? 0.02 : 0.001};
}
constexpr int slide_steps = 16;

std::set<int> asSet(const NodeList& list) {
  const auto host = toHost(list.nodes);
  std::set<int> nodes;
  for (std::int64_t i = 0; i < list.count; ++i)
    EXPECT_TRUE(nodes.insert(host(i)).second) << "twice: " << host(i);
  return nodes;
}

TEST(TouchedNodes, OnlyTheirAccelerationsAreReadAndOnlyTheyHaveForces) {
  const exec_space space;
  EnforcementConfig neutral_config = config();
  neutral_config.scheme = Scheme::energy_neutral;
  SceneRun run(smallOnLarge(), MPI_COMM_SELF, onOneRank, neutral_config);
  SceneRun all(smallOnLarge(), MPI_COMM_SELF, onOneRank, neutral_config);
  const Vec3 by_others = {0.1, -0.2, -0.3};
  int with_forces = 0, without = 0;
  for (int step = 0; step < slide_steps; ++step) {
    for (SceneRun* r : {&run, &all}) {
      r->scene.step();
      r->scene.move(1, slideAt(step));
      r->part.update(r->scene);
    }
    const std::vector<Vec3> acceleration(run.scene.x_new.size(), by_others);
    NeutralInput of_all = all.part.neutralInput(all.scene, acceleration);
    NeutralInput of_some = run.part.neutralInput(run.scene, acceleration);
    const View<double* [3]> some("test::some", run.part.surface().num_nodes);
    of_some.accelerations = [&](const NodeList& list) {
      const auto host = Kokkos::create_mirror_view(some);
      Kokkos::deep_copy(host, std::nan(""));
      EXPECT_FALSE(list.isAll());
      for (const int node : asSet(list))
        for (int d = 0; d < 3; ++d)
          host(node, d) = by_others[d];
      Kokkos::deep_copy(some, host);
      return some;
    };
    run.enforcement.enforce(space, run.part.surface(), run.part.ghosts(), run.part.pairs(), dt,
                            &of_some);
    all.enforcement.enforce(space, all.part.surface(), all.part.ghosts(), all.part.pairs(), dt,
                            &of_all);
    const std::size_t num_nodes = run.scene.x_new.size();
    EXPECT_EQ(run.part.total(run.enforcement, num_nodes, run.scene),
              all.part.total(all.enforcement, num_nodes, all.scene))
        << step;
    const std::set<int> listed = asSet(run.enforcement.touched());
    const auto forces = toHost(run.enforcement.forces().nodes);
    int pushed = 0;
    for (int node = 0; node < run.part.surface().num_nodes; ++node) {
      const bool is_pushed = forces(node, 0) != 0 || forces(node, 1) != 0 || forces(node, 2) != 0;
      EXPECT_TRUE(!is_pushed || listed.count(node) == 1) << step << ": " << node;
      pushed += is_pushed;
    }
    with_forces += pushed > 0;
    without += pushed == 0 && listed.empty();
  }
  EXPECT_GT(with_forces, 4);
  EXPECT_GT(without, 4);
}

TEST(TouchedNodes, ManyAreListedAsAllAndNoneAsNone) {
  const exec_space space;
  SceneRun run(smallOnLarge(), MPI_COMM_SELF, onOneRank);
  for (int step = 0; step < 5; ++step) {
    run.moveAndStep(1, slideAt(step));
  }
  const ContactHistory& pairs = run.enforcement.history();
  ASSERT_GT(pairs.count, 0);
  TouchedNodes touched("test", run.part.surface().num_nodes);
  EXPECT_EQ(touched.list().count, 0);
  EXPECT_FALSE(touched.list().isAll());
  touched.add(space, run.part.surface(), pairs);
  const std::set<int> listed = asSet(touched.list());
  EXPECT_GT(listed.size(), 4u);
  touched.add(space, run.part.surface(), pairs); // adding them twice lists them once
  EXPECT_EQ(asSet(touched.list()), listed);
  touched.clear(space);
  EXPECT_EQ(touched.list().count, 0);
  touched.add(space, run.part.surface(), pairs);
  EXPECT_EQ(asSet(touched.list()), listed);
  TouchedNodes of_few("test", static_cast<int>(listed.size()));
  of_few.add(space, run.part.surface(), pairs);
  EXPECT_TRUE(of_few.list().isAll());
  EXPECT_EQ(of_few.list().count, static_cast<std::int64_t>(listed.size()));
}

// Lists of edges are kept, too: edges are represented by their boxes, whose corners do not move
// farther than the edges do.
TEST(EdgeLists, AreKeptWithinTheMarginAndChangeNoBit) {
  EdgeRun anew(crossedRidges(0.05), MPI_COMM_SELF, onOneRank);
  EdgeRun kept(crossedRidges(0.05), MPI_COMM_SELF, onOneRank, config(), 0.2);
  constexpr int steps = 40;
  std::int64_t active = 0;
  for (int step = 0; step < steps; ++step) {
    const Vec3 motion = {0.002, 0, step < 20 ? -0.008 : 0.012};
    anew.move(1, motion);
    kept.move(1, motion);
    EXPECT_EQ(anew.step(), kept.step()) << step;
    EXPECT_EQ(anew.sums.penetrating, kept.sums.penetrating) << step;
    active += anew.sums.active;
  }
  EXPECT_GT(active, 5);
  EXPECT_EQ(anew.edges->search().searches(), steps);
  EXPECT_LT(kept.edges->search().searches(), steps / 3);
  EXPECT_GT(kept.edges->search().searches(), 1);
}

} // namespace
} // namespace brickwall::contact::testing
