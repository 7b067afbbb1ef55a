// The audit of candidate lists against the oracle: lists of the step and kept lists miss nothing,
// and the pairs that stale or narrow lists miss are counted exactly.
#include "contact/search/candidate_search.hpp"
#include "tests/contact/search/search_checks.hpp"
#include "tests/support/communicator.hpp"

#include <gtest/gtest.h>

#include <set>

namespace brickwall::contact::test {
namespace {

constexpr int num_kinds = 10;

void move(SurfaceCase& c, Random& random, double speed) {
  for (CaseNode& node : c.nodes) {
    node.x_old = node.x_new;
    for (int d = 0; d < 3; ++d)
      node.x_new[d] += random.real(-speed, speed);
  }
}

// (node id, face id) of all pairs of this rank's owned nodes, by the definition.
using Pairs = std::set<std::pair<global_id, global_id>>;
Pairs definedPairs(const SurfaceCase& c, const LocalSurface& local) {
  Pairs pairs;
  const Expected expected = expectedOnRank(c, local, rankOf(comm));
  for (std::size_t i = 0; i < local.nodes.size(); ++i)
    for (const int face : expected.pairs[i])
      pairs.emplace(c.nodes[local.nodes[i]].id, c.faces[face].id);
  return pairs;
}
std::int64_t missing(const Pairs& wanted, const Pairs& listed) {
  std::int64_t count = 0;
  for (const auto& pair : wanted)
    count += listed.count(pair) == 0;
  return allReduce(comm, count, MPI_SUM);
}

TEST(PairAudit, FindsNothingMissedByListsOfTheStepAndByKeptLists) {
  const exec_space space;
  for (std::uint64_t seed = 0; seed < 2 * num_kinds; ++seed)
    for (const SearchMethod method : all_methods)
      for (const double margin : {0.0, 0.2}) {
        SurfaceCase c = makeCase(seed, sizeOf(comm));
        Random random(seed);
        CandidateSearch search(comm, configOf(c, method), margin);
        for (int step = 0; step < 4; ++step) {
          const LocalSurface local = localSurface(c, rankOf(comm));
          search.update(space, local.surface);
          ASSERT_EQ(search.countMissedPairs(space, local.surface), 0)
              << c.name() << " by " << nameOf(method) << ", step " << step;
          move(c, random, 0.02);
        }
      }
}

TEST(PairAudit, CountsWhatListsOfSmallerBoxesMiss) {
  const exec_space space;
  std::int64_t all_missed = 0;
  for (std::uint64_t seed = 0; seed < 2 * num_kinds; ++seed) {
    const SurfaceCase c = makeCase(seed, sizeOf(comm));
    SurfaceCase narrow = c;
    narrow.node_tolerance *= 0.1;
    narrow.face_tolerance *= 0.1;
    const LocalSurface local = localSurface(c, rankOf(comm));
    CandidateSearch search(comm, configOf(narrow, SearchMethod::cluster));
    search.update(space, local.surface);
    const std::int64_t missed =
        countMissedPairs(space, comm, local.surface, search.ghosts(), search.pairs(),
                         configOf(c, SearchMethod::cluster));
    EXPECT_EQ(missed, missing(definedPairs(c, local), definedPairs(narrow, local))) << c.name();
    all_missed += missed;
  }
  EXPECT_GT(all_missed, 0);
}

// Lists of the previous step, as a wrong decision to keep them would leave them; the ghosts are
// those of that step, too.
TEST(PairAudit, CountsWhatStaleListsMiss) {
  const exec_space space;
  std::int64_t all_missed = 0;
  for (std::uint64_t seed = 0; seed < 2 * num_kinds; ++seed) {
    SurfaceCase c = makeCase(seed, sizeOf(comm));
    CandidateSearch search(comm, configOf(c, SearchMethod::paper));
    const LocalSurface before = localSurface(c, rankOf(comm));
    search.update(space, before.surface);
    const Pairs listed = definedPairs(c, before);
    Random random(seed);
    move(c, random, 0.5);
    const LocalSurface after = localSurface(c, rankOf(comm));
    const std::int64_t missed = search.countMissedPairs(space, after.surface);
    EXPECT_EQ(missed, missing(definedPairs(c, after), listed)) << c.name();
    all_missed += missed;
  }
  EXPECT_GT(all_missed, 0);
}

} // namespace
} // namespace brickwall::contact::test
