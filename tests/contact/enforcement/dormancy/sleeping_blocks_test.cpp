// Dormant rows of candidates wake in time: contact is the same as if everything were tested in
// every step, bit by bit.
#include "contact/enforcement/dormancy/sleeping_blocks.hpp"
#include "contact/search/candidate_search.hpp"
#include "tests/contact/enforcement/support/edge_run.hpp"
#include "tests/contact/enforcement/support/scene_run.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact::testing {
namespace {

const MPI_Comm world = MPI_COMM_WORLD;

// Five bricks, not quite flush, that swing, rotate and bend a little, each with its own period.
class SwingingBricks {
public:
  explicit SwingingBricks(double speed) : _speed(speed) {
    for (const Vec3& corner : {Vec3{0, 0, 0}, Vec3{2.02, 0, 0}, Vec3{1.01, 0.03, 1.02},
                               Vec3{3.04, -0.02, 1.01}, Vec3{-1.02, 0.01, 1.015}})
      scene.addBox(corner, {2, 1, 1}, {4, 2, 2});
    _rest = scene.x_new;
  }
  void moveTo(int step) {
    scene.step();
    for (std::size_t i = 0; i < _rest.size(); ++i)
      scene.x_new[i] = placeOf(_rest[i], scene.node_body[i], _speed * step);
  }
  Scene scene;

private:
  static double swing(double time, int body, int kind) {
    return std::sin(0.02 * time * (1 + 0.17 * body + 0.11 * kind) + 1.3 * body + 0.7 * kind);
  }
  static Vec3 placeOf(const Vec3& rest, int body, double time) {
    const Vec3 middle = {body == 0 ? 1.0 : body * 1.2, 0.5, body < 2 ? 0.5 : 1.5};
    const double angle = 0.01 * swing(time, body, 3), bend = 0.004 * swing(2 * time, body, 4);
    const Vec3 arm = rest - middle;
    const Vec3 turned = {arm.x - angle * arm.z, arm.y + bend * arm.x * arm.x,
                         arm.z + angle * arm.x};
    return middle + turned +
           Vec3{0.03 * swing(time, body, 0), 0.02 * swing(time, body, 1),
                0.03 * swing(time, body, 2)};
  }
  double _speed;
  std::vector<Vec3> _rest;
};

// Node-to-face and edge-to-edge contact with the program's search.
struct SearchedRun {
  template <class Cut>
  SearchedRun(const Scene& scene, MPI_Comm comm, const Cut& cut, double margin,
              const EnforcementConfig& c)
      : part(scene, comm, cut, 0), search(comm, searchOf(0.06), margin),
        enforcement(exec_space(), comm, part.surface(), part.nodeMass(), c, quantum(),
                    energyScale()),
        edges(exec_space(), comm, part.surface(), findFeatureEdges(comm, part.surface()),
              part.nodeMass(), searchOf(0.06), margin, c, quantum(), energyScale()) {}
  void step(const Scene& scene) {
    const exec_space space;
    part.update(scene);
    const auto stationary = enforcement.startMotion(space, part.surface());
    search.update(space, part.surface(), {}, {}, stationary);
    edges.gatherCoordinates(space, part.surface(), stationary);
    edges.findCandidates(space);
    sums = enforcement.enforce(space, part.surface(), search.ghosts(), search.pairs(), dt, nullptr,
                               &edges);
    asleep = enforcement.sleeping().numBlocks() - enforcement.sleeping().numAwake(exec_space());
    edges_asleep = edges.sleeping().numBlocks() - edges.sleeping().numAwake(exec_space());
  }
  std::vector<double> result() const {
    std::vector<double> all = numbersOf(enforcement.forces().nodes, part.surface().num_nodes);
    for (const auto& more : {numbersOf(enforcement.forces().ghost_corners, search.ghosts().count),
                             numbersOf(enforcement.status(), part.surface().num_nodes),
                             numbersOf(enforcement.gap(), part.surface().num_nodes)})
      all.insert(all.end(), more.begin(), more.end());
    for (const ContactSums& one : {sums.nodes, sums.edges})
      for (const double number : {double(one.penetrating), double(one.interactions),
                                  double(one.active), double(one.lost), one.deepest})
        all.push_back(number);
    return all;
  }
  ScenePart part;
  CandidateSearch search;
  Enforcement enforcement;
  EdgeContact edges;
  EnforcementSums sums;
  std::int64_t asleep = 0, edges_asleep = 0;
};

struct Count {
  std::int64_t penetrating = 0, woken = 0, asleep = 0, edges_asleep = 0;
};

// On a device no row sleeps with a search in every step.
constexpr bool rows_last = cluster_size > 1;

Count compare(double speed, double margin, int num_steps) {
  EnforcementConfig with = config(), without = config();
  with.friction = without.friction = 0.3;
  without.skip_stationary = false;
  const auto cut = [](int element) { return (element / 24) % sizeOf(world); };
  SwingingBricks bricks(speed);
  SearchedRun a(bricks.scene, world, cut, margin, with);
  SearchedRun b(bricks.scene, world, cut, margin, without);
  Count count;
  for (int step = 0; step < num_steps; ++step) {
    bricks.moveTo(step);
    const std::int64_t before = a.asleep;
    a.step(bricks.scene);
    b.step(bricks.scene);
    EXPECT_EQ(a.result(), b.result()) << "step " << step;
    count.penetrating += a.sums.nodes.penetrating;
    count.woken += a.asleep < before;
    count.asleep += a.asleep;
    count.edges_asleep += a.edges_asleep;
    EXPECT_EQ(b.asleep, 0);
  }
  for (std::int64_t* number :
       {&count.penetrating, &count.woken, &count.asleep, &count.edges_asleep})
    *number = allReduce(world, *number, MPI_SUM);
  return count;
}

TEST(SleepingBlocks, DormancyChangesNoContactOfSwingingBricks) {
  for (const double speed : {0.25, 1.0, 4.0}) {
    const Count count = compare(speed, 0, 250);
    EXPECT_GT(count.penetrating, 1000) << speed;
    if (sizeOf(world) > 1 || !rows_last) // most blocks have ghosts
      continue;
    EXPECT_GT(count.asleep, 50) << speed;
    EXPECT_GT(count.edges_asleep, 50) << speed;
    EXPECT_GT(count.woken, 5) << speed;
  }
}

TEST(SleepingBlocks, DormancyChangesNoContactWithKeptLists) {
  const Count count = compare(1.0, 0.05, 400);
  EXPECT_GT(count.penetrating, 1000);
  if (sizeOf(world) > 1)
    return;
  EXPECT_GT(count.asleep, 100);
  EXPECT_GT(count.woken, 10);
}

// The upper of two bodies swings over the lower one, rotates, rolls by up to `roll` and meets it
// from time to time.
void swing(const Scene& scene, double roll, std::int64_t least_asleep) {
  EnforcementConfig with = config(), without = config();
  without.skip_stationary = false;
  EdgeRun a(scene, MPI_COMM_SELF, onOneRank, with), b(scene, MPI_COMM_SELF, onOneRank, without);
  std::int64_t penetrating = 0, asleep = 0, woken = 0;
  for (int step = 0; step < 600; ++step) {
    const double angle = 0.3 * std::sin(0.013 * step), shift = 0.4 * std::sin(0.017 * step),
                 lift = 0.07 * std::sin(0.021 * step), rolled = roll * std::sin(0.031 * step);
    for (EdgeRun* run : {&a, &b}) {
      run->scene.step();
      for (std::size_t i = 0; i < scene.x_new.size(); ++i)
        if (scene.node_body[i] == 1) {
          const Vec3& x = scene.x_new[i];
          run->scene.x_new[i] = {x.x - angle * x.y + shift + rolled * x.z, x.y + angle * x.x,
                                 x.z + lift - rolled * (x.x + 0.2 * x.y)};
        }
    }
    const std::int64_t before = a.edges->sleeping().numAwake(exec_space());
    EXPECT_EQ(a.step(), b.step()) << step;
    EXPECT_EQ(a.sums.penetrating, b.sums.penetrating) << step;
    EXPECT_EQ(a.sums.deepest, b.sums.deepest) << step;
    const SleepingBlocks& sleeping = a.edges->sleeping();
    penetrating += a.sums.penetrating;
    woken += sleeping.numAwake(exec_space()) > before ||
             (before < sleeping.numBlocks() && a.sums.penetrating > 0);
    asleep += sleeping.numBlocks() - sleeping.numAwake(exec_space());
  }
  EXPECT_GT(penetrating, 50);
  if (rows_last) {
    EXPECT_GT(asleep, least_asleep);
    EXPECT_GT(woken, 1);
  }
}

TEST(SleepingBlocks, DormancyChangesNoContactOfEdges) {
  swing(crossedRidges(0.05), 0, 100);
}

TEST(SleepingBlocks, DormancyChangesNoContactOfBarsThatCrossFlush) {
  swing(crossedBars(0.05, 0, 0), 0.4, 20);
}

// A wall of four bricks that fly apart: after the first steps nothing is tested.
TEST(SleepingBlocks, BodiesThatFlyApartBecomeDormant) {
  if (!rows_last)
    GTEST_SKIP() << "on a device no row sleeps with a search in every step";
  Scene scene;
  for (const Vec3& corner : {Vec3{0, 0, 0}, Vec3{2, 0, 0}, Vec3{0, 0, 1}, Vec3{2, 0, 1}})
    scene.addBox(corner, {2, 1, 1}, {8, 4, 4});
  SearchedRun run(scene, MPI_COMM_SELF, onOneRank, 0, config());
  for (int step = 0; step < 20; ++step) {
    scene.step();
    for (int body = 0; body < 4; ++body)
      scene.move(body, {body % 2 ? 1e-3 : -1e-3, 0, body < 2 ? -1e-3 : 1e-3});
    run.step(scene);
    EXPECT_EQ(run.sums.nodes.penetrating + run.sums.edges.penetrating, 0);
    if (step > 0) {
      EXPECT_GT(5 * run.asleep, 4 * run.enforcement.sleeping().numBlocks()) << step;
      EXPECT_GT(5 * run.edges_asleep, 4 * run.edges.sleeping().numBlocks()) << step;
    }
  }
}

// A wall of four flush bricks, one of which moves: rows of the others sleep until one of these
// moves.
TEST(SleepingBlocks, FlushBodiesSleepWhileTheyAreAtRest) {
  if (!rows_last)
    GTEST_SKIP() << "on a device few rows sleep";
  EnforcementConfig with = config();
  with.least_depth = 1e-12;
  EnforcementConfig without = with;
  without.skip_stationary = false;
  Scene scene;
  for (const Vec3& corner : {Vec3{0, 0, 0}, Vec3{2, 0, 0}, Vec3{0, 0, 1}, Vec3{2, 0, 1}})
    scene.addBox(corner, {2, 1, 1}, {6, 3, 3});
  SearchedRun a(scene, MPI_COMM_SELF, onOneRank, 0.05, with);
  SearchedRun b(scene, MPI_COMM_SELF, onOneRank, 0.05, without);
  const std::int64_t num_blocks = a.enforcement.sleeping().numBlocks();
  std::int64_t penetrating = 0, before = 0;
  for (int step = 0; step < 30; ++step) {
    scene.step();
    if (step % 6 < 4)
      scene.move(3, {step < 15 ? -0.002 : 0.003, 0, step < 15 ? -0.004 : 0.005});
    if (step == 27)
      scene.move(0, {0, 0, 0.01});
    a.step(scene);
    b.step(scene);
    EXPECT_EQ(a.result(), b.result()) << step;
    penetrating += a.sums.nodes.penetrating;
    if (step == 26)
      before = a.asleep;
  }
  EXPECT_GT(penetrating, 100);
  EXPECT_GT(before, num_blocks / 4);
  EXPECT_LT(a.asleep, before / 2);
}

// Body 0 rests after it has left its box of the last search by less than the margin. A body far
// away, on the last rank, then makes all ranks search, which adds pairs to rows of bodies that
// rest.
TEST(SleepingBlocks, RowsAtRestWakeWhenASearchAddsPairs) {
  EnforcementConfig with = config(), without = config();
  without.skip_stationary = false;
  Scene scene;
  scene.addBox({0, 0, 0}, {1, 1, 3}, {1, 1, 1});
  scene.addBox({-0.05, -0.05, 3.7}, {1.1, 1.1, 3}, {1, 1, 1});
  scene.addBox({50, 0, 0}, {1, 1, 1}, {1, 1, 1});
  const auto cut = [](int element) { return element == 2 ? sizeOf(world) - 1 : 0; };
  SearchedRun a(scene, world, cut, 0.5, with), b(scene, world, cut, 0.5, without);
  std::int64_t penetrating = 0;
  for (int step = 0; step < 60; ++step) {
    scene.step();
    if (step == 5)
      scene.move(0, {0, 0, 0.2});
    if (step == 12)
      scene.move(2, {1, 0, 0});
    if (step >= 16 && step < 50)
      scene.move(0, {0, 0, 0.016});
    a.step(scene);
    b.step(scene);
    EXPECT_EQ(a.result(), b.result()) << step;
    penetrating += b.sums.nodes.penetrating;
  }
  EXPECT_GT(allReduce(world, penetrating, MPI_SUM), 0);
}

TEST(SurfaceMotion, SumsBoundTheMotionOfEveryNode) {
  const exec_space space;
  SwingingBricks bricks(1);
  ScenePart part(bricks.scene, MPI_COMM_SELF, onOneRank, 0);
  SurfaceMotion motion(space, "test", part.surface());
  std::vector<std::vector<double>> sums;
  std::vector<std::vector<Vec3>> places;
  for (int step = 0; step < 40; ++step) {
    bricks.moveTo(step);
    part.update(bricks.scene);
    motion.update(space, part.surface());
    sums.push_back(numbersOf(motion.bodies().sums, bricks.scene.num_bodies));
    places.push_back(bricks.scene.x_new);
  }
  for (int from = 0; from < 40; from += 7)
    for (int to = from; to < 40; ++to)
      for (std::size_t node = 0; node < places[0].size(); ++node)
        for (int d = 0; d < 3; ++d) {
          const double by = places[to][node][d] - places[from][node][d];
          const int low = 6 * bricks.scene.node_body[node] + d;
          EXPECT_LE(sums[to][low] - sums[from][low], by + 1e-15);
          EXPECT_GE(sums[to][low + 3] - sums[from][low + 3], by - 1e-15);
        }
}

// Two bodies; the sums are set explicitly.
TEST(SeparationBound, HoldsUntilTheGapMayCloseOrTheBodiesHaveRotated) {
  if (!host_accessible)
    GTEST_SKIP() << "on a host";
  const View<double* [6]> host("sums", 2);
  const View<global_id*> ids("ids", 2);
  const View<unsigned char*> is_at_rest("is_at_rest", 2);
  SeparationBound bound;
  bound.start(BodyMotions{ids, host, is_at_rest}, 0, 1);
  Separation apart;
  apart.max_spread = 0.1;
  apart.gap = 0.5;
  apart.normal = {0, 0, 1};
  apart.arm = 2;
  bound.include(apart, 1);
  const auto holds = [&](const Vec3& low, const Vec3& high) {
    for (int d = 0; d < 3; ++d) {
      host(0, d) = low[d];
      host(0, 3 + d) = high[d];
    }
    return bound.holds(BodyMotions{ids, host, is_at_rest}, 1e-12);
  };
  EXPECT_TRUE(holds({}, {}));
  EXPECT_TRUE(holds({0, 0, -0.49}, {0, 0, -0.49})); // w, closing
  EXPECT_FALSE(holds({0, 0, -0.51}, {0, 0, -0.51}));
  EXPECT_TRUE(holds({9, -9, 9}, {9, -9, 9})); // sideways and apart
  EXPECT_TRUE(holds({0, 0, -0.4}, {0, 0, -0.36})); // .4 + 2 * .04
  EXPECT_FALSE(holds({0, 0, -0.4}, {0, 0, -0.34})); // .4 + 2 * .06
  EXPECT_FALSE(holds({0, 0, 9}, {0, 0, 9.11})); // rotated too far for any bound
  // With a pair that has no bound, both bodies must be at rest.
  bound.include(Separation(), 1);
  EXPECT_FALSE(holds({}, {}));
  is_at_rest(0) = 1;
  EXPECT_FALSE(holds({}, {}));
  is_at_rest(1) = 1;
  EXPECT_TRUE(holds({}, {}));
}

} // namespace
} // namespace brickwall::contact::testing
