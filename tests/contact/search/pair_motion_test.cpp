// The fastest pair against all pairs that the search lists, on any number of ranks and with kept
// lists.
#include "contact/enforcement/edge_edge/edge_contact.hpp"
#include "contact/search/audit/pair_motion.hpp"
#include "contact/search/audit/read_back.hpp"
#include "contact/search/candidate_search.hpp"
#include "tests/contact/enforcement/support/scene_run.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact::testing {
namespace {

const MPI_Comm world = MPI_COMM_WORLD;

// A spinning brick on one at rest; every node has a motion of its own.
Scene spinningOnTop() {
  Scene scene;
  scene.addBox({0, 0, 0}, {3, 3, 1}, {3, 3, 1});
  scene.addBox({0.3, 0.2, 1.05}, {3, 2, 1}, {3, 2, 1});
  for (std::size_t i = 0; i < scene.x_new.size(); ++i)
    if (scene.node_body[i] == 1)
      scene.x_new[i] += cross(Vec3{0.05, -0.2, 0.1}, scene.x_new[i] - Vec3{1, 1, 1});
  return scene;
}

SearchConfig searchOf(double tolerance) {
  SearchConfig search;
  search.node_tolerance = search.face_tolerance = tolerance;
  search.drop_same_body = true;
  return search;
}

// How far a node moves towards the inside of a face; 0 if their boxes, seen from the node, do not
// meet. In these scenes nothing moves apart as a whole.
double motionInto(const Scene& scene, int node, const Scene::Face& face) {
  Box box;
  Quad quad[2];
  Vec3 from[2][4];
  for (int k = 0; k < 4; ++k) {
    quad[0].corner[k] = scene.x_old[face.nodes[k]], quad[1].corner[k] = scene.x_new[face.nodes[k]];
    from[0][k] = scene.x_old[node] - quad[0].corner[k];
    from[1][k] = scene.x_new[node] - quad[1].corner[k];
    box.include(from[0][k]), box.include(from[1][k]);
  }
  Box origin;
  origin.include(Vec3{0, 0, 0});
  double inwards = 0, motion = 0;
  for (int k = 0; k < 4; ++k) {
    inwards = maxOf(inwards, dot(from[0][k], areaVector(quad[0])) / norm(areaVector(quad[0])) -
                                 dot(from[1][k], areaVector(quad[1])) / norm(areaVector(quad[1])));
    motion = maxOf(motion, norm(from[1][k] - from[0][k]));
  }
  return box.overlaps(origin) ? minOf(inwards, motion) : 0;
}

PairMotion bruteForce(const Scene& scene, const std::vector<IdPair>& pairs) {
  PairMotion found;
  for (const IdPair& pair : pairs)
    for (const Scene::Face& face : scene.faces)
      if (face.id == pair.face) {
        const double motion = motionInto(scene, static_cast<int>(pair.node), face);
        const bool is_lower =
            pair.node != found.node ? pair.node < found.node : pair.face < found.face;
        if (motion > found.motion || (motion == found.motion && is_lower))
          found = {{pair.node, pair.face, scene.node_body[static_cast<std::size_t>(pair.node)],
                    face.body},
                   motion,
                   false};
      }
  return found;
}

void expectSame(const PairMotion& a, const PairMotion& b) {
  EXPECT_EQ(a.motion, b.motion);
  EXPECT_EQ(a.node, b.node);
  EXPECT_EQ(a.face, b.face);
  EXPECT_EQ(a.node_body, b.node_body);
  EXPECT_EQ(a.face_body, b.face_body);
}

TEST(FastestPair, IsTheOneThatAllPairsShow) {
  const exec_space space;
  const Scene scene = spinningOnTop();
  const ScenePart whole(scene, MPI_COMM_SELF, onOneRank, 0);
  CandidateSearch all(MPI_COMM_SELF, searchOf(0.05));
  all.update(space, whole.surface());
  const PairMotion expected =
      bruteForce(scene, candidateIds(space, whole.surface(), all.ghosts(), all.pairs()));
  EXPECT_GT(expected.motion, 0.1);

  const ScenePart part(scene, world, scattered, 0);
  for (const double margin : {0.0, 1.0}) { // kept lists contain faster pairs that are too far apart
    CandidateSearch search(world, searchOf(0.05), margin);
    search.update(space, part.surface());
    FastestPair fastest;
    const auto find = [&](const Vec3& mean, double limit) {
      return fastest.find(space, world, part.surface(), search.ghosts(), search.pairs(), mean,
                          limit);
    };
    for (const Vec3& mean : {Vec3(), Vec3{0.05, -0.05, 0.01}, Vec3{-5, 0, 0}}) {
      for (const double share : {0.0, 0.5, 1 - 1e-12})
        expectSame(find(mean, share * expected.motion), expected);
      const PairMotion unnamed = find(mean, 1);
      EXPECT_LE(unnamed.motion, expected.motion);
      EXPECT_EQ(unnamed.node, -1);
    }
  }
}

TEST(FastestPair, OfBodiesThatMoveAsOneDoesNotMove) {
  Scene scene = spinningOnTop();
  scene.x_new = scene.x_old;
  for (int body = 0; body < 2; ++body)
    scene.move(body, {5, 0, 0});
  const ScenePart part(scene, world, scattered, 0);
  CandidateSearch search(world, searchOf(0.05));
  search.update(exec_space(), part.surface());
  EXPECT_GT(allReduce(world, search.pairs().count, MPI_SUM), 0);
  const PairMotion fastest = FastestPair().find(exec_space(), world, part.surface(),
                                                search.ghosts(), search.pairs(), Vec3(), 1);
  EXPECT_LE(fastest.motion, 1e-15); // x + 5 - x rounds
}

// A cube of one element on another one, with or without a gap, moves by this.
double motionOfTopCube(const Vec3& by, double gap, const Vec3& turn = {0, 0, 0}) {
  const exec_space space;
  Scene scene;
  scene.addBox({0, 0, 0}, {1, 1, 1}, {1, 1, 1});
  scene.addBox({0.3, 0.2, 1 + gap}, {1, 1, 1}, {1, 1, 1});
  for (std::size_t i = 0; i < scene.x_new.size(); ++i)
    scene.x_new[i] += cross(turn, scene.x_new[i]);
  scene.move(1, by);
  const ScenePart part(scene, MPI_COMM_SELF, onOneRank, 0);
  CandidateSearch search(MPI_COMM_SELF, searchOf(0.5));
  search.update(space, part.surface());
  EXPECT_GT(search.pairs().count, 0);
  EdgeContact edges(space, MPI_COMM_SELF, part.surface(),
                    findFeatureEdges(MPI_COMM_SELF, part.surface()), part.nodeMass(), searchOf(0.5),
                    0, config(), quantum(), energyScale());
  edges.findCandidates(space, part.surface());
  EXPECT_GT(edges.search().pairs().count, 0);
  return maxOf(
      FastestPair()
          .find(space, MPI_COMM_SELF, part.surface(), search.ghosts(), search.pairs(), Vec3(), 0)
          .motion,
      edges.fastestPair(space, MPI_COMM_SELF, Vec3(), 0).motion);
}

TEST(FastestPair, IsOneThatMayMeetAndMovesInwards) {
  EXPECT_NEAR(motionOfTopCube({0, 0, -0.3}, 0.1), 0.3, 1e-14);
  EXPECT_EQ(motionOfTopCube({0, 0, 0.3}, 0), 0); // leaves
  EXPECT_EQ(motionOfTopCube({0, 0, -0.3}, 0.31), 0); // does not arrive
  EXPECT_EQ(motionOfTopCube({-0.2, 0.1, 0}, 0.1), 0); // passes
  // both turn as one, by atan(0.1), and expand by 0.5 %: inwards, nothing moves but by rounding
  EXPECT_LE(motionOfTopCube({0, 0, 0}, 0.2, {0, 0.1, 0}), 1e-14);
}

// Bars on edge that cross in mid-cell.
TEST(FastestPair, OfCrossingEdgesIsThatOfTheirEnds) {
  const exec_space space;
  const double c = std::sqrt(0.5);
  Scene scene;
  scene.addBrick({3, 3, 3}, {3, 3, 3}, 1, [&](const Vec3& p) {
    const double y = p.y - 3, z = p.z - 3; // the ridge is where both are 0
    return Vec3{p.x - 1.5, c * (y - z), c * (y + z)};
  });
  scene.addBrick({3, 3, 3}, {3, 3, 3}, 1, [&](const Vec3& p) {
    return Vec3{c * (p.x - p.z), p.y - 1.513, 0.15 + c * (p.x + p.z)};
  });
  scene.move(1, {0, 0.1, -0.2});
  for (const bool is_cut : {false, true}) {
    const ScenePart part(scene, is_cut ? world : MPI_COMM_SELF, is_cut ? scattered : onOneRank, 0);
    EdgeContact edges(space, part.comm(), part.surface(),
                      findFeatureEdges(part.comm(), part.surface()), part.nodeMass(),
                      searchOf(0.01), 0, config(), quantum(), energyScale());
    edges.findCandidates(space, part.surface());
    const PairMotion fastest = edges.fastestPair(space, part.comm(), Vec3(), 0.1);
    EXPECT_TRUE(fastest.is_of_edges);
    EXPECT_NEAR(fastest.motion, std::sqrt(0.05), 1e-14);
    EXPECT_EQ(fastest.node_body + fastest.face_body, 1);
    EXPECT_GE(fastest.node, 0);
  }
}

} // namespace
} // namespace brickwall::contact::testing
