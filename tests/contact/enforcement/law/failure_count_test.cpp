// Forces that do not fit the fixed point are counted once each, however many rounds of corrections
// see them, and with their kind of contact; largestForce() finds the largest of them.
#include "tests/contact/enforcement/support/edge_run.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact::testing {
namespace {

// The ridges have crossed by 0.005 in this step.
Scene pressedRidges() {
  Scene scene = crossedRidges(-0.005);
  scene.cameBy(1, {0, 0, -0.006});
  return scene;
}

// The plate's four inner nodes and the block's nine on it are in contact.
Scene blockOnPlate() {
  Scene scene;
  scene.addBox({0, 0, -1}, {4, 4, 1}, {4, 4, 1});
  const int block = scene.addBox({0.75, 0.75, -0.02}, {2, 2, 1}, {2, 2, 1});
  scene.cameBy(block, {0, 0, -0.02});
  return scene;
}

struct Outcome {
  EnforcementSums sums;
  LargestForce of_nodes, of_edges;
};

// Without corrections: the plain penalty scheme.
Outcome outcomeOf(Scene scene, double times_mass, int corrections) {
  for (double& m : scene.mass)
    m *= times_mass;
  for (Scene::Face& face : scene.faces)
    face.surface_mass *= times_mass;
  const exec_space space;
  const ScenePart part(scene, MPI_COMM_SELF, onOneRank, 0.3);
  EnforcementConfig c = config();
  c.scheme = corrections > 0 ? Scheme::energy_neutral : Scheme::penalty;
  c.corrections = maxOf(corrections, 1);
  Enforcement enforcement(space, MPI_COMM_SELF, part.surface(), part.nodeMass(), c, quantum(),
                          energyScale());
  EdgeContact edges(space, MPI_COMM_SELF, part.surface(),
                    findFeatureEdges(MPI_COMM_SELF, part.surface()), part.nodeMass(), searchOf(0.2),
                    0, c, quantum(), energyScale());
  edges.findCandidates(space, part.surface());
  const NeutralInput input = part.neutralInput(scene, std::vector<Vec3>(scene.x_new.size()));
  Outcome outcome;
  outcome.sums =
      enforcement.enforce(space, part.surface(), part.ghosts(), part.pairs(), dt, &input, &edges);
  outcome.of_nodes = largestForce(space, MPI_COMM_SELF, part.surface(), enforcement.history());
  outcome.of_edges = edges.largestForce(space, MPI_COMM_SELF);
  return outcome;
}
EnforcementSums sumsOf(const Scene& scene, double times_mass, int corrections) {
  return outcomeOf(scene, times_mass, corrections).sums;
}

TEST(FailureCount, CountsAnOversizedEdgeForceOnceAndAmongEdges) {
  EXPECT_EQ(sumsOf(pressedRidges(), 1, 2).failures(), 0);
  for (const int corrections : {0, 1, 2, 5}) {
    const EnforcementSums sums = sumsOf(pressedRidges(), 1e12, corrections);
    EXPECT_EQ(sums.edges.active, 1);
    EXPECT_EQ(sums.edges.invalid, 1) << corrections;
    EXPECT_EQ(sums.nodes.invalid, 0) << corrections;
    EXPECT_EQ(sums.nodes.problem(), "");
    EXPECT_NE(sums.edges.problem(), "");
  }
}

TEST(FailureCount, CountsAnOversizedNodeForceOnce) {
  EXPECT_EQ(sumsOf(blockOnPlate(), 1, 2).failures(), 0);
  for (const int corrections : {0, 1, 2, 5}) {
    const EnforcementSums sums = sumsOf(blockOnPlate(), 1e12, corrections);
    EXPECT_EQ(sums.nodes.active, 9 + 4);
    EXPECT_EQ(sums.nodes.invalid, 9 + 4) << corrections;
    EXPECT_EQ(sums.edges.invalid, 0);
  }
}

TEST(LargestForce, FindsTheContactWithTheLargestForce) {
  const Outcome outcome = outcomeOf(blockOnPlate(), 1, 0);
  const LargestForce& largest = outcome.of_nodes;
  EXPECT_GT(largest.force, 0);
  EXPECT_FALSE(largest.is_of_edges);
  EXPECT_NE(largest.node_body, largest.face_body);
  EXPECT_GE(largest.node, 0);
  EXPECT_GE(largest.face, 0);
  EXPECT_EQ(outcome.of_edges.force, 0);
  const Outcome heavier =
      outcomeOf(blockOnPlate(), 1e12, 0); // forces that do not fit are reported as well
  EXPECT_NEAR(heavier.of_nodes.force / largest.force, 1e12, 1);
  EXPECT_EQ(heavier.of_nodes.node, largest.node);
  EXPECT_EQ(heavier.of_nodes.face, largest.face);
}

TEST(LargestForce, NamesBothEdges) {
  const LargestForce largest = outcomeOf(pressedRidges(), 1e12, 2).of_edges;
  EXPECT_TRUE(largest.is_of_edges);
  EXPECT_GT(largest.force, largestPairForce(quantum()));
  EXPECT_LT(outcomeOf(pressedRidges(), 1, 2).of_edges.force, largestPairForce(quantum()));
  EXPECT_EQ(largest.node_body + largest.face_body, 1); // 0 and 1
  EXPECT_GE(largest.node, 0);
  EXPECT_GE(largest.face, 0);
}

} // namespace
} // namespace brickwall::contact::testing
