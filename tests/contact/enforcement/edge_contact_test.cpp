// Edges that cross between nodes push each other before any node is inside.
#include "tests/contact/enforcement/support/edge_run.hpp"
#include "tests/contact/enforcement/support/spring_bricks.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact::testing {
namespace {

TEST(EdgeContact, CrossingRidgesPushFromTheFirstPenetrationOn) {
  EdgeRun run(crossedRidges(0.01), MPI_COMM_SELF, onOneRank);
  run.step();
  EXPECT_EQ(run.sums.interactions, 0);
  run.move(1, {0, 0, -0.015});
  const auto force = run.step();
  EXPECT_EQ(run.sums.active, 1);
  EXPECT_NEAR(run.sums.max_penetration, 0.005, 1e-12);
  std::int64_t sum[3] = {0, 0, 0};
  Vec3 moment, push;
  for (std::size_t i = 0; i < force.size(); ++i) {
    const Vec3 f = {static_cast<double>(force[i][0]), static_cast<double>(force[i][1]),
                    static_cast<double>(force[i][2])};
    for (int d = 0; d < 3; ++d)
      sum[d] += force[i][d];
    moment += cross(run.scene.x_new[i], f);
    if (run.scene.node_body[i] == 1)
      push += f;
  }
  for (int d = 0; d < 3; ++d)
    EXPECT_EQ(sum[d], 0);
  // F = k p: half of s m_red/dt^2; the four ends have mass 1/8 + 1/8 (inner nodes of an edge) and
  // the weights 1/2 +- .013.
  const double a = 0.5 - 0.013, b = 0.5 + 0.013;
  const double inverse_mass = 2 * 4 * 0.5 * 0.5 + 4 * (a * a + b * b);
  EXPECT_NEAR(push.z * Quantum::forForceScale(100).value,
              0.5 * EnforcementConfig().penalty / (dt * dt) / inverse_mass * 0.005, 1e-12);
  EXPECT_NEAR(norm(moment) / push.z, 0, 1e-12);
  // A node is inside only half a diagonal later.
  auto nodes = config();
  nodes.reference_step = dt;
  Enforcement enforcement(exec_space(), MPI_COMM_SELF, run.part.surface(), run.part.nodeMass(),
                          nodes, Quantum::forForceScale(100), LimbScale::forLargest(1e3));
  EXPECT_EQ(
      enforcement.enforce(exec_space(), run.part.surface(), run.part.ghosts(), run.part.pairs(), dt)
          .nodes.interactions,
      0);
}

// As with a host whose surface was at rest before it made the edges.
TEST(EdgeContact, FirstStepGathersNodesThatAreFlaggedAsAtRest) {
  const exec_space space;
  EdgeRun run(crossedRidges(0.01), MPI_COMM_SELF, onOneRank, config(), 0.1);
  EdgeRun expected(crossedRidges(0.01), MPI_COMM_SELF, onOneRank, config(), 0.1);
  run.part.update(run.scene);
  for (int step = 0; step < 3; ++step)
    run.motion.update(space, run.part.surface());
  const View<const unsigned char*> stationary = run.motion.stationaryNodes();
  const auto flags = numbersOf(stationary, stationary.extent(0));
  EXPECT_EQ(flags, std::vector<double>(flags.size(), SurfaceMotion::twice));
  run.edges->gatherCoordinates(space, run.part.surface(), stationary);
  run.edges->findCandidates(space);
  expected.step();
  const auto boxesOf = [](const EdgeRun& of) {
    return numbersOf(of.edges->search().sweptBoxes(), of.edges->nodeIds().extent(0));
  };
  EXPECT_EQ(boxesOf(run), boxesOf(expected));
  EXPECT_GT(expected.edges->search().pairs().count, 0);
  EXPECT_EQ(run.edges->search().pairs().count, expected.edges->search().pairs().count);
}

TEST(EdgeContact, BecomesActiveWhenEdgesCrossAndEndsWhenTheySeparate) {
  EdgeRun crossed(crossedRidges(-0.02), MPI_COMM_SELF, onOneRank);
  crossed.step();
  EXPECT_EQ(crossed.sums.active, 0); // an initial overlap gives no force
  EdgeRun run(crossedRidges(0.001), MPI_COMM_SELF, onOneRank);
  run.move(1, {0, 0, -0.01});
  run.step();
  EXPECT_EQ(run.sums.active, 1);
  run.move(1, {0, 0, 0.05});
  run.step();
  EXPECT_EQ(run.sums.interactions, 0);
}

TEST(EdgeContact, SlidesAlongSegmentsOfAnEdgeAsAlongOneEdge) {
  EdgeRun run(crossedRidges(0.01), MPI_COMM_SELF, onOneRank);
  run.step();
  run.move(1, {0, 0, -0.02});
  double last = 0;
  for (int step = 0; step < 9;
       ++step) { // from the middle of an edge over its end, 0.9 of its length
    const auto force = run.step();
    ASSERT_EQ(run.sums.active, 1) << step;
    double push = 0;
    for (std::size_t i = 0; i < force.size(); ++i)
      if (run.scene.node_body[i] == 1)
        push += static_cast<double>(force[i][2]);
    // m_red of a mid-edge and of a node differ by a factor of 2; nothing jumps.
    if (step > 0) {
      EXPECT_NEAR(push / last, 1, 0.25) << step;
    }
    last = push;
    run.move(1, {0.1, 0, 0});
  }
}

// A bar whose lower side lies across a ridge, with edges 0.6 apart.
struct BarOnRidge {
  explicit BarOnRidge(double left, double right)
      : run(sceneAt(left, right), MPI_COMM_SELF, onOneRank) {}

  // The next step, with the edges at these heights above the ridge.
  void step(double left, double right) {
    run.scene.step();
    const Scene moved = sceneAt(left, right);
    run.scene.x_new = moved.x_new;
    run.step();
  }
  static Scene sceneAt(double left, double right) {
    const double sine = (right - left) / 0.6, cosine = std::sqrt(1 - sine * sine);
    Scene scene;
    scene.addBrick({3, 3, 3}, {3, 3, 3}, 1, [](const Vec3& p) {
      const double c = std::sqrt(0.5), y = p.y - 3, z = p.z - 3; // y = z = 0 is the ridge
      return Vec3{p.x - 1.5, c * (y - z), c * (y + z)};
    });
    scene.addBrick({0.6, 3, 0.6}, {1, 3, 1}, 1, [&](const Vec3& p) {
      return Vec3{-0.3 + cosine * p.x - sine * p.z, p.y - 1.513, left + sine * p.x + cosine * p.z};
    });
    return scene;
  }
  EdgeRun run;
};

// While the left edge carries the bar, the right one sinks in without facing the ridge.
TEST(EdgeContact, EdgeThatComesToFaceAnotherCarriesFromThereOnHoweverDeepItIs) {
  BarOnRidge bar(0.001, 0.1);
  bar.run.step();
  for (const double left : {-0.01, -0.06, -0.12, -0.18}) {
    bar.step(left, left + 0.1);
    ASSERT_EQ(bar.run.sums.interactions, 1) << left;
  }
  for (const double right : {-0.12, -0.16}) {
    bar.step(-0.18, right);
    ASSERT_EQ(bar.run.sums.interactions, 1) << right;
  }
  bar.step(-0.18, -0.19); // the sine to the side is 0.033 before and -0.017 now; the ridge spans it
  EXPECT_EQ(bar.run.sums.interactions, 2);
  const auto pairs = toHost(bar.run.edges->history().interactions);
  const int second = pairs(0).offset > pairs(1).offset ? 0 : 1;
  EXPECT_GT(pairs(second).offset, 0.15); // only what this step added is loaded
  EXPECT_NEAR(pairs(second).depth, 0.03, 0.005);
}

TEST(EdgeContact, EdgesThatHaveMetDeepWithoutContactStayWithout) {
  BarOnRidge bar(-0.18, -0.21);
  bar.run.step();
  bar.step(-0.181, -0.212);
  EXPECT_EQ(bar.run.sums.interactions, 0);
}

TEST(EdgeContact, ParallelAndFlushEdgesAreLeftToNodeToFaceContact) {
  Scene scene; // a running bond: edges cross at right angles in one plane
  scene.addBox({0, 0, 0}, {2, 1, 1}, {2, 1, 1});
  const int top = scene.addBox({1, 0, 0.99}, {2, 1, 1}, {2, 1, 1});
  scene.cameBy(top, {0, 0, -0.01});
  EdgeRun run(scene, MPI_COMM_SELF, onOneRank);
  run.step();
  EXPECT_EQ(run.sums.interactions, 0);
}

TEST(EdgeContact, BarsNarrowerThanTheirElementsAreInContactWhereverTheyCross) {
  for (const double rolled : {0.0, 0.02, 0.1, 0.5})
    for (const double inclined : {0.0, 0.02, 0.1}) {
      EdgeRun run(crossedBars(0.01, rolled, inclined), MPI_COMM_SELF, onOneRank);
      run.step();
      EXPECT_EQ(run.sums.interactions, 0) << rolled << " " << inclined;
      run.move(1, {0, 0, -0.02});
      const auto force = run.step();
      EXPECT_GT(run.sums.active, 0) << rolled << " " << inclined;
      std::int64_t up = 0, all = 0;
      for (std::size_t i = 0; i < force.size(); ++i) {
        all += force[i][2];
        up += run.scene.node_body[i] == 1 ? force[i][2] : 0;
      }
      EXPECT_EQ(all, 0);
      EXPECT_GT(up, 0) << rolled << " " << inclined;
    }
  // Flush: each of the two edges of one bar lies on both of the other.
  EdgeRun flush(crossedBars(0.01, 0, 0), MPI_COMM_SELF, onOneRank);
  flush.move(1, {0, 0, -0.02});
  flush.step();
  EXPECT_EQ(flush.sums.active, 4);
  EXPECT_NEAR(flush.sums.deepest, 0.01, 1e-12);
}

TEST(EdgeContact, BarsWithNodesOverEachOtherAreLeftToNodeToFaceContact) {
  EdgeRun run(crossedBars(0.01, 0, 0, 20), MPI_COMM_SELF, onOneRank);
  run.move(1, {0, 0, -0.02});
  run.step();
  EXPECT_EQ(run.sums.interactions, 0);
}

TEST(EdgeContact, EdgesThatPassEachOtherOutsideAreNotInContact) {
  Scene scene = crossedRidges(0.01);
  EdgeRun run(scene, MPI_COMM_SELF, onOneRank);
  run.move(1, {0, 4, -0.02}); // beyond the end of the lower one's side
  run.step();
  EXPECT_EQ(run.sums.interactions, 0);
}

// Every rank finds the same contacts; elements are distributed one by one.
TEST(EdgeContact, EveryPartitionGivesTheSameIntegers) {
  EnforcementConfig c = config();
  c.friction = 0.3;
  c.damping = 0.05;
  const Scene scene = crossedRidges(0.01);
  EdgeRun one(scene, MPI_COMM_SELF, onOneRank, c);
  EdgeRun many(scene, MPI_COMM_WORLD, scattered, c);
  for (const Vec3& by : {Vec3{0.1, 0, -0.02}, Vec3{0.2, 0.3, -0.01}, Vec3{0.3, 0.3, 0.005}}) {
    one.move(1, by);
    many.move(1, by);
    const auto expected = one.step();
    EXPECT_EQ(expected, many.step());
    EXPECT_EQ(one.sums.interactions, many.sums.interactions);
    EXPECT_EQ(one.sums.terms.sum[friction_work].value(LimbScale::forLargest(1e3)),
              many.sums.terms.sum[friction_work].value(LimbScale::forLargest(1e3)));
    EXPECT_EQ(one.sums.active, 1) << by.x;
  }
}

// Worst |E/E_0 - 1| while the ridges hit each other and separate.
double worstEnergyError(bool with_edges, double* deepest) {
  EnforcementConfig config;
  SpringBricks bricks(crossedRidges(0.002), config, 0.1, 0.8, 0.3);
  if (with_edges)
    bricks.addEdges(searchOf(0.2));
  for (std::size_t i = 0; i < bricks.velocity.size(); ++i)
    if (bricks.scene().node_body[i] == 1)
      bricks.velocity[i] = {0.001, 0, -0.01};
  double start = 0, worst = 0;
  for (int step = 0; step < 400; ++step) {
    bricks.step();
    if (step == 0)
      start = bricks.energy;
    worst = std::max(worst, std::fabs(bricks.energy / start - 1));
    *deepest = std::max({*deepest, bricks.sums.max_penetration, bricks.edge_sums.max_penetration});
  }
  return worst;
}
TEST(EdgeContact, ImpactOfRidgesKeepsTheEnergyAndStaysShallow) {
  double deepest = 0, deepest_without = 0;
  const double error = worstEnergyError(true, &deepest);
  worstEnergyError(false, &deepest_without);
  std::printf("  edge impact: energy %.2e, depth %.3f h (without edges %.3f h)\n", error, deepest,
              deepest_without);
  EXPECT_LT(error, 5e-3);
  EXPECT_LT(deepest, 0.1);
}

} // namespace
} // namespace brickwall::contact::testing
