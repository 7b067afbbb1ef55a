// Kept lists against brute force: random surfaces that move, slowly and fast, on all ranks and with
// all methods; rounding at the limit of the margin; errors thrown on all ranks; no allocation in a
// step that keeps its lists.
#include "contact/search/candidate_search.hpp"
#include "contact/surface/face_access.hpp"
#include "tests/contact/search/search_checks.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/communicator.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>

namespace brickwall::contact::test {
namespace {

using brickwall::testing::allocationsOf;
using brickwall::testing::no_allocations;

// x^n := x^{n+1}, then every body moves by up to `speed` along each axis, and every node by a small
// random amount.
void advance(SurfaceCase& c, Random& random, double speed) {
  std::map<global_id, Point> motion;
  for (const CaseNode& node : c.nodes)
    motion[node.body] = {};
  for (auto& body : motion)
    for (double& x : body.second)
      x = random.real(-speed, speed);
  for (CaseNode& node : c.nodes) {
    node.x_old = node.x_new;
    for (int d = 0; d < 3; ++d)
      node.x_new[d] += motion[node.body][d] + random.real(-0.05, 0.05) * speed;
  }
}

// [entry of pairs.faces] whether the pair passes the test of the step; entries of no row are 0.
View<int*> stepTests(const Surface& surface, const GhostFaces& ghosts,
                     const CandidatePairs& pairs) {
  const View<int*> passes("test::passes", pairs.faces.extent(0));
  const FaceAccess faces{surface, ghosts};
  Kokkos::parallel_for(
      "test::stepTests", rangePolicy(exec_space(), pairs.num_rows),
      KOKKOS_LAMBDA(const std::int64_t row) {
        const StepTest& test = pairs.step_test;
        for (std::int64_t i = pairs.begin(row); i < pairs.end(row); ++i)
          passes(i) =
              !test.is_needed || faces.boxesOverlap(pairs.node(row), pairs.faces(i),
                                                    test.node_tolerance, test.face_tolerance);
      });
  Kokkos::fence();
  return passes;
}

// The brute-force pairs of the step are exactly the listed pairs that pass its test, in the same
// order, and ghosts have the coordinates of their owners.
::testing::AssertionResult stepIsComplete(const SurfaceCase& c, const LocalSurface& local,
                                          const CandidateSearch& search) {
  const Surface& surface = local.surface;
  const GhostFaces& ghosts = search.ghosts();
  const CandidatePairs& pairs = search.pairs();
  std::map<global_id, const CaseFace*> face_of;
  for (const CaseFace& face : c.faces)
    face_of[face.id] = &face;
  const auto ghost_ids = toHost(ghosts.face_ids);
  const auto x_old = toHost(ghosts.coordinates_old), x_new = toHost(ghosts.coordinates_new);
  for (int g = 0; g < ghosts.count; ++g)
    for (int i = 0; i < 12; ++i) {
      const CaseNode& node = c.nodes[face_of.at(ghost_ids(g))->corners[i / 3]];
      if (x_old(g, i) != node.x_old[i % 3] || x_new(g, i) != node.x_new[i % 3])
        return ::testing::AssertionFailure() << "ghost face " << ghost_ids(g) << " is behind";
    }
  const Expected expected = expectedOnRank(c, local, rankOf(comm));
  const auto passes = toHost(stepTests(surface, ghosts, pairs));
  const HostRows rows(pairs);
  for (int row = 0; row < pairs.num_rows; ++row) {
    std::vector<global_id> found, wanted;
    for (const HostRows::Entry& entry : rows.entries(row))
      if (passes(entry.place))
        found.push_back(entry.face < surface.num_faces ? c.faces[local.faces[entry.face]].id
                                                       : ghost_ids(entry.face - surface.num_faces));
    const int node = rows.node(row);
    for (const int face : expected.pairs[node])
      wanted.push_back(c.faces[face].id);
    if (found != wanted)
      return ::testing::AssertionFailure()
             << "node " << c.nodes[local.nodes[node]].id << ": " << found.size()
             << " faces listed that overlap in this step, " << wanted.size() << " by brute force";
  }
  return ::testing::AssertionSuccess();
}

// Runs the case and compares each step; returns the number of searches, or -1 after a difference.
std::int64_t runCase(SurfaceCase c, SearchMethod method, double margin, double speed, int steps) {
  const exec_space space;
  Random random(c.seed + 1000);
  CandidateSearch search(comm, configOf(c, method), margin);
  for (int step = 0; step < steps; ++step) {
    const LocalSurface local = localSurface(c, rankOf(comm));
    search.update(space, local.surface);
    const auto complete = stepIsComplete(c, local, search);
    EXPECT_TRUE(complete) << c.name() << ", step " << step << ", rank " << rankOf(comm);
    if (!okOnAllRanks(comm, complete))
      return -1;
    advance(c, random, speed);
  }
  EXPECT_EQ(search.updates(), steps);
  return search.searches();
}

constexpr double margin = 0.2;
constexpr int num_kinds = 10, steps = 12;

TEST(CandidateSearch, SlowMotionKeepsListsThatMissNothing) {
  std::int64_t searches = 0, updates = 0;
  for (std::uint64_t seed = 0; seed < 4 * num_kinds; ++seed)
    for (const SearchMethod method : all_methods) {
      const std::int64_t made =
          runCase(makeCase(seed, sizeOf(comm)), method, margin, 0.1 * margin, steps);
      ASSERT_GT(made, 0);
      searches += made;
      updates += steps;
    }
  EXPECT_LT(searches, updates / 2);
  EXPECT_GT(searches, 2 * 4 * num_kinds); // some cases search again
}

// Some body exceeds the margin in each step: all steps search, except in empty cases.
TEST(CandidateSearch, FastMotionSearchesInEveryStep) {
  for (std::uint64_t seed = 0; seed < 2 * num_kinds; ++seed)
    for (const SearchMethod method : all_methods) {
      SurfaceCase c = makeCase(seed, sizeOf(comm));
      const bool is_empty = c.nodes.empty();
      const double fast =
          100 * margin; // at least one body moves by more than half the margin along an axis
      ASSERT_EQ(runCase(std::move(c), method, margin, fast, 6), is_empty ? 1 : 6);
    }
}

TEST(CandidateSearch, WithoutAMarginEveryStepSearches) {
  for (std::uint64_t seed = 0; seed < num_kinds; ++seed)
    ASSERT_EQ(runCase(makeCase(seed, sizeOf(comm)), SearchMethod::cluster, 0, 1e-6, 4), 4);
}

// One body moves fast through the others, which are almost at rest.
TEST(CandidateSearch, AFastBrickIsNotMissed) {
  const exec_space space;
  for (std::uint64_t seed = 0; seed < 3 * num_kinds; seed += num_kinds) // jittered walls
    for (const SearchMethod method : all_methods) {
      SurfaceCase c = makeCase(seed, sizeOf(comm));
      CandidateSearch search(comm, configOf(c, method), margin);
      for (int step = 0; step < 40; ++step) {
        const LocalSurface local = localSurface(c, rankOf(comm));
        search.update(space, local.surface);
        const auto complete = stepIsComplete(c, local, search);
        ASSERT_TRUE(okOnAllRanks(comm, complete))
            << c.name() << ", step " << step << ": " << complete.message();
        for (CaseNode& node : c.nodes) {
          node.x_old = node.x_new;
          node.x_new[0] += (node.body == 0 ? 0.07 : 0.0001) * (step < 20 ? 1 : -1);
        }
      }
      EXPECT_GT(search.searches(), 10);
      EXPECT_LT(search.searches(), 40);
    }
}

// A host may change both configurations: no step relies on the previous one.
TEST(CandidateSearch, BothConfigurationsMayJump) {
  const exec_space space;
  Random random(5);
  SurfaceCase c = makeCase(0, sizeOf(comm));
  CandidateSearch search(comm, configOf(c, SearchMethod::cluster), margin);
  const SurfaceCase start = c;
  for (int step = 0; step < 20; ++step) {
    const double jump = step % 5 == 4 ? 3 * margin : 0.2 * margin;
    for (std::size_t n = 0; n < c.nodes.size(); ++n)
      for (int d = 0; d < 3; ++d) {
        c.nodes[n].x_old[d] = start.nodes[n].x_old[d] + random.real(-jump, jump);
        c.nodes[n].x_new[d] = start.nodes[n].x_new[d] + random.real(-0.2, 0.2) * margin;
      }
    const LocalSurface local = localSurface(c, rankOf(comm));
    search.update(space, local.surface);
    ASSERT_TRUE(okOnAllRanks(comm, stepIsComplete(c, local, search))) << "step " << step;
  }
  EXPECT_LT(search.searches(), 20);
}

// A node and a face move by half the margin, to within a few units in the last place, and end near
// the positions where their boxes begin to touch.
TEST(CandidateSearch, RoundingAtTheEndOfTheMarginLosesNoPair) {
  const exec_space space;
  std::int64_t kept_and_touching = 0;
  for (std::uint64_t seed = 0; seed < 6000; ++seed) {
    Random random(seed);
    SurfaceCase c;
    c.node_tolerance = random.real(0, 0.1);
    c.face_tolerance = random.real(0, 0.1);
    const double wide = random.real(0.01, 0.3), place = random.real(-1, 1) * (seed % 2 ? 1e3 : 1);
    const double ulp = std::numeric_limits<double>::epsilon() * std::max(std::fabs(place), 0.1);
    const auto nearly = [&](double value, int below, int above) {
      return value + ulp * (random.below(below + above) - below);
    };
    const double node_end = place,
                 face_end = nearly(place + c.node_tolerance + c.face_tolerance, 2, 4);
    const double node_motion = random.chance(0.2) ? 0 : nearly(wide / 2, 8, 2);
    const double face_motion = random.chance(0.2) ? 0 : nearly(wide / 2, 8, 2);
    addNode(c, 0, {node_end - node_motion, 0.5, 0.5});
    const double y[4] = {0, 1, 1, 0}, z[4] = {0, 0, 1, 1};
    for (int k = 0; k < 4; ++k)
      addNode(c, 1, {face_end + face_motion, y[k], z[k]});
    addFace(c, 1, {1, 2, 3, 4});
    for (CaseNode& node : c.nodes) {
      node.owner = rankOf(comm);
      node.sharers = {node.owner};
    }
    c.faces[0].rank = rankOf(comm);

    CandidateSearch search(MPI_COMM_SELF, configOf(c, SearchMethod::cluster), wide);
    search.update(space, localSurface(c, rankOf(comm)).surface);
    for (CaseNode& node : c.nodes)
      node.x_new[0] = node.body == 0 ? node_end : face_end;
    const LocalSurface moved = localSurface(c, rankOf(comm));
    search.update(space, moved.surface);
    ASSERT_TRUE(stepIsComplete(c, moved, search)) << "seed " << seed;
    kept_and_touching += search.searches() == 1 && boxesMeet(c, c.nodes[0], c.faces[0]);
  }
  EXPECT_GT(kept_and_touching, 300);
}

TEST(CandidateSearch, PairsAreNotMissingAfterStepsForGhostsAlone) {
  const exec_space space;
  SurfaceCase c = makeCase(0, sizeOf(comm));
  Random random(1);
  CandidateSearch search(comm, configOf(c, SearchMethod::cluster), margin);
  for (const bool with_pairs : {false, false, true, false, true}) {
    advance(c, random, 0.05 * margin);
    const LocalSurface local = localSurface(c, rankOf(comm));
    if (with_pairs) {
      search.update(space, local.surface);
      EXPECT_TRUE(okOnAllRanks(comm, stepIsComplete(c, local, search)));
    } else {
      search.updateGhosts(space, local.surface);
    }
  }
  EXPECT_EQ(search.searches(), 2); // the first update, and the first one with pairs
}

// Bodies at rest are kept whatever their distance from the origin.
TEST(CandidateSearch, RestingNodesFarAwayCostNoSearch) {
  const exec_space space;
  const SurfaceCase c = makeCase(8, sizeOf(comm)); // coordinates of 1e300
  const LocalSurface local = localSurface(c, rankOf(comm));
  CandidateSearch search(comm, configOf(c, SearchMethod::cluster), 1e-6);
  for (int step = 0; step < 5; ++step)
    search.update(space, local.surface);
  EXPECT_EQ(search.searches(), 1);
  if (rankOf(comm) == sizeOf(comm) - 1)
    search.forget();
  search.update(space, local.surface);
  EXPECT_EQ(search.searches(), 2);
}

// Corners of faces change in place, which sizes and Views do not show.
TEST(CandidateSearch, AForgottenSurfaceIsSeenAnew) {
  const exec_space space;
  SurfaceCase c = makeCase(0, sizeOf(comm));
  LocalSurface local = localSurface(c, rankOf(comm));
  const View<int* [4]> corners("test::corners", local.faces.size());
  Kokkos::deep_copy(corners, local.surface.face_to_nodes);
  local.surface.face_to_nodes = corners;
  for (const SearchMethod method : all_methods) {
    CandidateSearch search(comm, configOf(c, method), margin);
    search.update(space, local.surface);
    for (CaseFace& face :
         c.faces) // each takes the corners of the previous face of its rank and body
      for (const CaseFace& other : c.faces)
        if (other.rank == face.rank && other.body == face.body)
          face.corners = other.corners;
    Kokkos::deep_copy(corners, localSurface(c, rankOf(comm)).surface.face_to_nodes);
    search.forget();
    search.update(space, local.surface);
    EXPECT_TRUE(okOnAllRanks(comm, stepIsComplete(c, local, search)));
    c = makeCase(0, sizeOf(comm));
    Kokkos::deep_copy(corners, localSurface(c, rankOf(comm)).surface.face_to_nodes);
  }
}

TEST(CandidateSearch, AllRanksThrowTheSameMessageForACoordinateThatIsNotFinite) {
  const exec_space space;
  const SurfaceCase c = makeCase(10, sizeOf(comm));
  const LocalSurface good = localSurface(c, rankOf(comm));
  for (std::size_t n = 0; n < c.nodes.size(); n += 17)
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
      CandidateSearch search(comm, configOf(c, all_methods[n / 17 % 3]), margin);
      search.update(space, good.surface);
      search.update(space, good.surface); // keeps the lists
      EXPECT_EQ(search.searches(), 1);
      SurfaceCase broken = c;
      (n % 2 == 0 ? broken.nodes[n].x_new : broken.nodes[n].x_old)[n % 3] = bad;
      std::string message = "nothing thrown";
      try {
        search.update(space, localSurface(broken, rankOf(comm)).surface);
      } catch (const PhysicsError& error) {
        message = error.what();
      }
      EXPECT_EQ(message, broadcast(comm, message)); // rank 0's
      EXPECT_NE(message.find("node " + std::to_string(c.nodes[n].id) + " on rank " +
                             std::to_string(c.nodes[n].sharers.front())),
                std::string::npos)
          << message;
      search.update(space, good.surface); // usable again
      EXPECT_EQ(search.searches(), 2);
      EXPECT_TRUE(okOnAllRanks(comm, stepIsComplete(c, good, search)));
    }
}

TEST(CandidateSearch, TolerancesAndMarginMustBeFiniteLengths) {
  SearchConfig config;
  for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN(), HUGE_VAL}) {
    EXPECT_THROW(CandidateSearch(comm, config, bad), InputError);
    SearchConfig negative;
    negative.face_tolerance = bad;
    EXPECT_THROW(GlobalSearch(comm, negative), InputError);
    EXPECT_THROW(CandidateSearch(comm, negative, 5), InputError); // although -1 + 5/2 > 0
  }
}

TEST(CandidateSearch, SteadyStepsAllocateNothing) {
  const exec_space space;
  const LocalSurface local = localSurface(makeCase(30, sizeOf(comm)), rankOf(comm));
  for (const SearchMethod method : all_methods) {
    CandidateSearch search(comm, configOf(makeCase(30, sizeOf(comm)), method), margin);
    const auto step = [&] { search.update(space, local.surface); };
    EXPECT_NE(allocationsOf(step), no_allocations); // the first search allocates: they are seen
    EXPECT_EQ(allocationsOf(step), no_allocations);
    EXPECT_EQ(allocationsOf(step), no_allocations);
    EXPECT_EQ(search.searches(), 1);
  }
}

} // namespace
} // namespace brickwall::contact::test
