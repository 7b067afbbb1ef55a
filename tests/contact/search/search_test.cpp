// Global and local search against a brute-force evaluation of their definition, on random surfaces;
// no allocation in a steady step. The global search alone is tested in ghost_search_test.cpp.
#include "contact/search/local_search.hpp"
#include "tests/contact/search/ghost_cases.hpp"
#include "tests/contact/search/host_rows.hpp"
#include "tests/contact/search/search_checks.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <limits>

namespace brickwall::contact::test {
namespace {

const MPI_Comm comm = MPI_COMM_WORLD;

::testing::AssertionResult pairsAre(const SurfaceCase& c, const LocalSurface& local,
                                    const Expected& expected, const std::vector<int>& ghost_faces,
                                    const CandidatePairs& pairs) {
  std::vector<bool> seen(local.nodes.size(), false);
  std::int64_t count = 0;
  const HostRows rows(pairs);
  if (pairs.num_rows != static_cast<int>(local.nodes.size()))
    return ::testing::AssertionFailure() << pairs.num_rows << " rows";
  for (int r = 0; r < pairs.num_rows; ++r) {
    const int n = rows.node(r);
    if (n < 0 || n >= pairs.num_rows || seen[n])
      return ::testing::AssertionFailure() << "row " << r << " is of node " << n;
    seen[n] = true;
    const auto& row = expected.pairs[n];
    const std::vector<int> listed = rows.faces(r);
    count += static_cast<std::int64_t>(listed.size());
    if (listed.size() != row.size())
      return ::testing::AssertionFailure() << "node " << c.nodes[local.nodes[n]].id << " has "
                                           << listed.size() << " faces, expected " << row.size();
    for (std::size_t i = 0; i < row.size(); ++i) {
      const int index = listed[i];
      const int found = index < local.surface.num_faces
                            ? local.faces[index]
                            : ghost_faces[index - local.surface.num_faces];
      if (found != row[i])
        return ::testing::AssertionFailure()
               << "node " << c.nodes[local.nodes[n]].id << " has face " << c.faces[found].id
               << ", expected " << c.faces[row[i]].id;
    }
  }
  if (pairs.count != count)
    return ::testing::AssertionFailure() << "count is " << pairs.count << ", rows hold " << count;
  return ::testing::AssertionSuccess();
}

struct Counts {
  std::int64_t ghosts = 0, pairs = 0;
};

// One step on both searches; false when any rank found a difference.
bool checkStep(const SurfaceCase& c, GlobalSearch& global, LocalSearch& local_search,
               Counts* counts = nullptr) {
  const exec_space space;
  const int rank = rankOf(comm);
  const LocalSurface local = localSurface(c, rank);
  const Expected expected = expectedOnRank(c, local, rank);
  const GhostFaces& ghosts = global.findGhosts(space, local.surface);
  const CandidatePairs& pairs = local_search.findCandidatePairs(space, local.surface);
  space.fence();
  if (counts) {
    counts->ghosts += ghosts.count;
    counts->pairs += pairs.count;
  }
  const auto ghosts_ok = ghostsAre(c, expected.ghosts, ghosts, global.config().method);
  EXPECT_TRUE(ghosts_ok) << c.name() << ", " << nameOf(global.config().method);
  const auto pairs_ok =
      ghosts_ok ? pairsAre(c, local, expected, facesOf(c, ghosts), pairs) : ghosts_ok;
  EXPECT_TRUE(pairs_ok) << c.name() << ", " << nameOf(global.config().method);
  return okOnAllRanks(comm, ghosts_ok && pairs_ok);
}

// Checks a step of make(seed) for `num_seeds` seeds with all methods.
template <class Make>
void checkCases(std::uint64_t num_seeds, const Make& make, Counts& counts) {
  for (std::uint64_t seed = 0; seed < num_seeds; ++seed)
    for (const SearchMethod method : all_methods) {
      const SurfaceCase c = make(seed, sizeOf(comm));
      GlobalSearch global(comm, configOf(c, method));
      LocalSearch local(global);
      ASSERT_TRUE(checkStep(c, global, local, &counts)) << c.name();
    }
  // The cases do have pairs.
  EXPECT_GT(allReduce(comm, counts.pairs, MPI_SUM), 100000);
}

TEST(SearchTest, GhostsAndPairsEqualBruteForceOnRandomSurfaces) {
  Counts counts;
  ASSERT_NO_FATAL_FAILURE(checkCases(260, makeCase, counts));
  if (sizeOf(comm) > 1) {
    EXPECT_GT(allReduce(comm, counts.ghosts, MPI_SUM), 10000);
  }
}

// Own faces and ghosts: also on one rank.
TEST(SearchTest, PairsOfBoxesEqualInFloatsAreDecidedInDoubles) {
  Counts counts;
  checkCases(60, makeHardCase, counts);
}

TEST(SearchTest, BuffersOfEarlierStepsDoNotShowInLaterOnes) {
  SurfaceCase first = makeCase(0, sizeOf(comm));
  for (const SearchMethod method : all_methods) {
    GlobalSearch global(comm, configOf(first, method));
    LocalSearch local(global);
    for (std::uint64_t seed = 0; seed < 30; ++seed) { // large, small and empty cases alternate
      SurfaceCase c = makeCase(seed, sizeOf(comm));
      c.node_tolerance = first.node_tolerance;
      c.face_tolerance = first.face_tolerance;
      c.drop_same_body = first.drop_same_body;
      global.forget();
      ASSERT_TRUE(checkStep(c, global, local)) << c.name();
    }
  }
}

// Rows longer than the results that a query keeps on its stack.
TEST(SearchTest, LongRowsOfCoincidentFacesAreComplete) {
  SurfaceCase c;
  c.kind = "coincident";
  Random random(1);
  addQuads(c, 300, 3, random, [&](int, int k) { return Point{k % 2 * 1.0, k / 2 * 1.0, 0}; });
  distribute(c, random, sizeOf(comm));
  for (const SearchMethod method : all_methods) {
    GlobalSearch global(comm, configOf(c, method));
    LocalSearch local(global);
    EXPECT_TRUE(checkStep(c, global, local));
  }
}

std::atomic<int> num_allocations{0};

TEST(SearchTest, ASteadyStepAllocatesNothing) {
  const exec_space space;
  const SurfaceCase c = makeCase(30, sizeOf(comm));
  const LocalSurface surface = localSurface(c, rankOf(comm));
  GlobalSearch global(comm, configOf(c, SearchMethod::paper));
  LocalSearch local(global);
  const auto step = [&] {
    global.findGhosts(space, surface.surface);
    local.findCandidatePairs(space, surface.surface);
  };
  Kokkos::Tools::Experimental::set_allocate_data_callback([](Kokkos_Profiling_SpaceHandle,
                                                             const char*, const void*,
                                                             std::uint64_t) { ++num_allocations; });
  num_allocations = 0;
  step();
  EXPECT_GT(num_allocations, 0); // the first step allocates: the counter works
  num_allocations = 0;
  step();
  Kokkos::Tools::Experimental::set_allocate_data_callback(nullptr);
  EXPECT_EQ(num_allocations, 0);
}

} // namespace
} // namespace brickwall::contact::test
