// Faces that a host code may have: triangles, faces without an area, and ranks or whole surfaces
// without any.
#include "contact/search/candidate_search.hpp"
#include "contact/surface/features/feature_edges.hpp"
#include "tests/contact/enforcement/support/scene_run.hpp"
#include "tests/support/communicator.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact::testing {
namespace {

// Faces with the corners of each face in the order of `corners`, with new ids.
void addFaces(Scene& scene, const std::array<int, 4>& corners) {
  const std::size_t count = scene.faces.size();
  global_id id = 0;
  for (const Scene::Face& face : scene.faces)
    id = std::max(id, face.id);
  for (std::size_t f = 0; f < count; ++f) {
    Scene::Face copy = scene.faces[f];
    for (int c = 0; c < 4; ++c)
      copy.nodes[c] = scene.faces[f].nodes[corners[c]];
    copy.id = ++id;
    scene.faces.push_back(copy);
  }
}

TEST(OddFaces, WithoutAnAreaChangeNoForce) {
  const auto expected = alone(pressed())->step();
  for (const std::array<int, 4>& corners :
       {std::array<int, 4>{0, 0, 0, 0}, {0, 0, 1, 1}, {0, 1, 0, 1}, {0, 1, 1, 0}, {2, 1, 2, 2}}) {
    Scene scene = pressed();
    addFaces(scene, corners);
    SceneRun run(scene, comm, scattered);
    EXPECT_EQ(run.step(), expected);
    EXPECT_EQ(run.sums.failures(), 0);
    EXPECT_NO_THROW(findFeatureEdges(comm, run.part.surface()));
  }
}

// Each face as two triangles, of which one has another corner twice.
Scene ofTriangles() {
  Scene scene = pressed();
  const std::size_t count = scene.faces.size();
  addFaces(scene, {0, 0, 2, 3});
  for (std::size_t f = 0; f < count; ++f)
    scene.faces[f].nodes[3] = scene.faces[f].nodes[2];
  for (Scene::Face& face : scene.faces)
    face.surface_mass *= 0.5;
  return scene;
}

TEST(OddFaces, TrianglesPressAsQuadrilateralsDo) {
  const auto expected = alone(pressed());
  const auto single = alone(ofTriangles());
  SceneRun run(ofTriangles(), comm, scattered);
  for (int step = 0; step < 4; ++step) {
    const auto quads = step == 0 ? expected->step() : expected->moveAndStep(1, {0, 0.002, -0.005});
    const auto triangles = step == 0 ? single->step() : single->moveAndStep(1, {0, 0.002, -0.005});
    EXPECT_EQ(step == 0 ? run.step() : run.moveAndStep(1, {0, 0.002, -0.005}), triangles);
    double force = 0, force_of_quads = 0;
    for (std::size_t node = 0; node < triangles.size(); ++node)
      if (single->scene.node_body[node] == 1) {
        force += static_cast<double>(triangles[node][2]);
        force_of_quads += static_cast<double>(quads[node][2]);
      }
    EXPECT_GT(force, 0);
    EXPECT_NEAR(force, force_of_quads, 0.5 * force_of_quads); // other faces, other stiffness
  }
}

TEST(OddFaces, MayBeNowhereOrOnOneRankOnly) {
  const exec_space space;
  for (const bool has_some : {false, true}) {
    const Scene scene = has_some ? pressed() : Scene();
    const int last = sizeOf(comm) - 1;
    SceneRun run(scene, comm, [last](int) { return last; });
    if (has_some) {
      EXPECT_GT((run.step(), run.sums.interactions), 0);
    } else {
      const auto sums = run.enforcement.enforce(space, run.part.surface(), run.part.ghosts(),
                                                run.part.pairs(), dt);
      EXPECT_EQ(sums.active() + sums.failures(), 0);
    }
    for (const SearchMethod method :
         {SearchMethod::cluster, SearchMethod::paper, SearchMethod::reference}) {
      SearchConfig search_config;
      search_config.method = method;
      search_config.node_tolerance = search_config.face_tolerance = 0.1;
      CandidateSearch search(comm, search_config);
      for (int step = 0; step < 3; ++step)
        EXPECT_EQ(allReduce(comm, search.update(space, run.part.surface()).count, MPI_SUM) > 0,
                  has_some);
    }
    EXPECT_NO_THROW(findFeatureEdges(comm, run.part.surface()));
  }
}

} // namespace
} // namespace brickwall::contact::testing
