// Contact forces with lists kept over steps equal those of a search in every step bit for bit, also
// where contacts are lost because they are deeper than the search reaches.
#include "contact/search/candidate_search.hpp"
#include "tests/contact/enforcement/support/scene_run.hpp"
#include "tests/support/communicator.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact::testing {
namespace {

constexpr double margin = 0.1;

// Two stacks of three bricks, each rotated a little.
Scene stacks() {
  Scene scene;
  for (int b = 0; b < 6; ++b) {
    const double angle = 0.05 * (b - 2.5);
    const Vec3 corner = {1.02 * (b % 2), 0.03 * b, 0.99 * (b / 2)};
    scene.addBrick({1, 1, 1}, {3, 3, 3}, 1 + 0.1 * b, [&](const Vec3& p) {
      return corner + Vec3{p.x * std::cos(angle) - p.y * std::sin(angle),
                           p.x * std::sin(angle) + p.y * std::cos(angle), p.z + 0.02 * angle * p.x};
    });
  }
  return scene;
}

// Bricks swing into each other and out again, each with its own period; nodes are disturbed at
// random.
void swing(Scene& scene, const std::vector<Vec3>& start, int step) {
  scene.step();
  for (std::size_t i = 0; i < start.size(); ++i) {
    const int b = scene.node_body[i];
    const double t = 0.011 * step * (1 + 0.2 * b);
    scene.x_new[i] = start[i] + Vec3{0.05 * std::sin(2 * t + b), 0.1 * std::sin(t + 2 * b),
                                     0.15 * std::sin(3 * t + 3 * b)};
    for (int d = 0; d < 3; ++d)
      scene.x_new[i][d] += 0.001 * std::sin(5.0 * i + 7 * d + 0.3 * step);
  }
}

// A rank's part with a search and its contacts.
struct SearchedRun {
  SearchedRun(const Scene& scene, double kept_by)
      : part(scene, comm, scattered, 0), search(comm, tolerances(), kept_by),
        enforcement(exec_space(), comm, part.surface(), part.nodeMass(), config(), quantum(),
                    energyScale()) {}

  static SearchConfig tolerances() {
    SearchConfig config;
    config.node_tolerance = config.face_tolerance = 0.02;
    config.drop_same_body = true;
    return config;
  }

  // Collective. Forces of all nodes [3 * global node + xyz].
  std::vector<std::int64_t> step(const Scene& scene) {
    const exec_space space;
    part.update(scene);
    const Surface& surface = part.surface();
    const CandidatePairs& pairs = search.update(space, surface);
    sums = enforcement.enforce(space, surface, search.ghosts(), pairs, dt).nodes;
    sumOverRanks(comm, sums);
    const ContactForces& forces = enforcement.forces();
    search.reverseSum(space, surface.face_to_nodes, forces.ghost_corners, forces.nodes);
    const auto nodes = toHost(forces.nodes);
    std::vector<std::int64_t> total(3 * scene.x_new.size(), 0);
    for (std::size_t i = 0; i < part.nodes().size(); ++i)
      for (int d = 0; d < 3; ++d)
        total[3 * part.nodes()[i] + d] = nodes(i, d);
    brickwall::allReduce(comm, total.data(), static_cast<int>(total.size()), MPI_SUM);
    return total;
  }

  ScenePart part;
  CandidateSearch search;
  Enforcement enforcement;
  ContactSums sums;
};

TEST(CandidateSearch, ForcesWithKeptListsEqualThoseOfASearchInEveryStep) {
  Scene scene = stacks();
  const std::vector<Vec3> start = scene.x_new;
  SearchedRun every(scene, 0), kept(scene, margin);
  constexpr int steps = 400;
  std::int64_t active = 0, lost = 0;
  for (int step = 0; step < steps; ++step) {
    swing(scene, start, step);
    const auto expected = every.step(scene);
    ASSERT_EQ(kept.step(scene), expected) << "step " << step;
    ASSERT_EQ(kept.sums.interactions, every.sums.interactions);
    ASSERT_EQ(kept.sums.active, every.sums.active);
    ASSERT_EQ(kept.sums.lost, every.sums.lost);
    ASSERT_EQ(kept.sums.max_penetration, every.sums.max_penetration);
    ASSERT_EQ(kept.sums.terms.sum[spring_stored].value(energyScale()),
              every.sums.terms.sum[spring_stored].value(energyScale()));
    active += every.sums.active;
    lost += every.sums.lost;
  }
  EXPECT_EQ(every.search.searches(), steps);
  EXPECT_LT(kept.search.searches(), steps / 3);
  EXPECT_GT(active, 10 * steps); // there are many contacts, some deeper than the tolerance
  EXPECT_GT(lost, 100);
}

} // namespace
} // namespace brickwall::contact::testing
