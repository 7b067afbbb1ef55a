// Forces that do not fit the fixed point are counted once each, however many rounds of corrections see them, and where they belong.
#include "contact/edge_run.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact::testing {
namespace {

// The ridges have crossed by .005 in this step.
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

EnforcementSums sumsOf(Scene scene, double times_mass, int corrections) {
  for (double& m : scene.mass)
    m *= times_mass;
  for (Scene::Face& face : scene.faces)
    face.surface_mass *= times_mass;
  const exec_space space;
  const ScenePart part(scene, MPI_COMM_SELF, onOneRank, 0.3);
  EnforcementConfig c = config();
  c.scheme = Scheme::energy_neutral;
  c.corrections = corrections;
  Enforcement enforcement(space, MPI_COMM_SELF, part.surface(), part.nodeMass(), c, quantum(),
                          energyScale());
  EdgeContact edges(space, MPI_COMM_SELF, part.surface(),
                    findFeatureEdges(MPI_COMM_SELF, part.surface()), part.nodeMass(), searchOf(0.2),
                    0, c, quantum(), energyScale());
  edges.findCandidates(space, part.surface());
  const NeutralInput input = part.neutralInput(scene, std::vector<Vec3>(scene.x_new.size()));
  return enforcement.enforce(space, part.surface(), part.ghosts(), part.pairs(), dt, &input,
                             &edges);
}

TEST(FailureCount, AForceOfEdgesThatDoesNotFitCountsOnceAndAmongEdges) {
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

TEST(FailureCount, AForceOfANodeThatDoesNotFitCountsOnce) {
  EXPECT_EQ(sumsOf(blockOnPlate(), 1, 2).failures(), 0);
  for (const int corrections : {0, 1, 2, 5}) {
    const EnforcementSums sums = sumsOf(blockOnPlate(), 1e12, corrections);
    EXPECT_EQ(sums.nodes.active, 9 + 4);
    EXPECT_EQ(sums.nodes.invalid, 9 + 4) << corrections;
    EXPECT_EQ(sums.edges.invalid, 0);
  }
}

} // namespace
} // namespace brickwall::contact::testing
