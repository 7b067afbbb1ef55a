// Global and local search against a brute-force evaluation of their definition, on random surfaces, and what else the
// search promises: invariants of the partners, the way back, errors found together, no allocation in a steady step.
#include "contact/global_search.hpp"
#include "contact/local_search.hpp"
#include "host_rows.hpp"
#include "search_oracle.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <limits>

namespace brickwall::contact::test {
namespace {

const MPI_Comm comm = MPI_COMM_WORLD;
constexpr SearchMethod both_methods[] = {SearchMethod::paper, SearchMethod::reference};

SearchConfig configOf(const SurfaceCase& c, SearchMethod method) {
  SearchConfig config;
  config.method = method;
  config.node_tolerance = c.node_tolerance;
  config.face_tolerance = c.face_tolerance;
  config.drop_same_body = c.drop_same_body;
  return config;
}

const char* nameOf(SearchMethod method) {
  return method == SearchMethod::paper ? "paper" : "reference";
}

// Stops at the first difference, which makes a readable message.
::testing::AssertionResult ghostsAre(const SurfaceCase& c, const std::vector<int>& expected,
                                     const GhostFaces& ghosts) {
  if (ghosts.count != static_cast<int>(expected.size()))
    return ::testing::AssertionFailure()
           << ghosts.count << " ghosts found, " << expected.size() << " expected";
  const auto ids = onHost(ghosts.face_ids), bodies = onHost(ghosts.bodies);
  const auto corners = onHost(ghosts.corner_ids);
  const auto x_old = onHost(ghosts.coordinates_old), x_new = onHost(ghosts.coordinates_new);
  const auto attributes = onHost(ghosts.attributes);
  for (int g = 0; g < ghosts.count; ++g) {
    const CaseFace& face = c.faces[expected[g]];
    bool same = ids(g) == face.id && bodies(g) == face.body;
    for (int k = 0; k < 4; ++k) {
      const CaseNode& node = c.nodes[face.corners[k]];
      same = same && corners(g, k) == node.id;
      for (int d = 0; d < 3; ++d)
        same = same && x_old(g, 3 * k + d) == node.x_old[d] && x_new(g, 3 * k + d) == node.x_new[d];
    }
    for (int a = 0; a < num_test_attributes; ++a)
      same = same && attributes(g, a) == testAttribute(face.id, a);
    if (!same)
      return ::testing::AssertionFailure()
             << "ghost " << g << " is face " << ids(g) << ", expected face " << face.id
             << " of rank " << face.rank << " with its data";
  }
  return ::testing::AssertionSuccess();
}

::testing::AssertionResult pairsAre(const SurfaceCase& c, const LocalSurface& local,
                                    const Expected& expected, const CandidatePairs& pairs) {
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
                            : expected.ghosts[index - local.surface.num_faces];
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

bool okOnAllRanks(bool ok) {
  return allReduce(comm, ok ? 1 : 0, MPI_MIN) == 1;
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
  const CandidatePairs& pairs =
      local_search.findCandidatePairs(space, local.surface, ghosts, global.boxes());
  space.fence();
  if (counts) {
    counts->ghosts += ghosts.count;
    counts->pairs += pairs.count;
  }
  const auto ghosts_ok = ghostsAre(c, expected.ghosts, ghosts);
  EXPECT_TRUE(ghosts_ok) << c.name() << ", " << nameOf(global.config().method);
  const auto pairs_ok = ghosts_ok ? pairsAre(c, local, expected, pairs) : ghosts_ok;
  EXPECT_TRUE(pairs_ok) << c.name() << ", " << nameOf(global.config().method);
  return okOnAllRanks(ghosts_ok && pairs_ok);
}

TEST(SearchTest, GhostsAndPairsEqualBruteForceOnRandomSurfaces) {
  Counts counts;
  for (std::uint64_t seed = 0; seed < 260; ++seed)
    for (const SearchMethod method : both_methods) {
      const SurfaceCase c = makeCase(seed, sizeOf(comm));
      GlobalSearch global(comm, configOf(c, method));
      LocalSearch local(configOf(c, method));
      ASSERT_TRUE(checkStep(c, global, local, &counts)) << c.name();
    }
  // The cases are not hollow.
  EXPECT_GT(allReduce(comm, counts.pairs, MPI_SUM), 100000);
  if (sizeOf(comm) > 1) {
    EXPECT_GT(allReduce(comm, counts.ghosts, MPI_SUM), 10000);
  }
}

TEST(SearchTest, BuffersOfEarlierStepsDoNotShowInLaterOnes) {
  SurfaceCase first = makeCase(0, sizeOf(comm));
  for (const SearchMethod method : both_methods) {
    GlobalSearch global(comm, configOf(first, method));
    LocalSearch local(configOf(first, method));
    for (std::uint64_t seed = 0; seed < 30; ++seed) { // large, small and empty ones in turn
      SurfaceCase c = makeCase(seed, sizeOf(comm));
      c.node_tolerance = first.node_tolerance;
      c.face_tolerance = first.face_tolerance;
      c.drop_same_body = first.drop_same_body;
      ASSERT_TRUE(checkStep(c, global, local)) << c.name();
    }
  }
}

// Rows longer than what a query keeps on its stack.
TEST(SearchTest, LongRowsOfCoincidentFacesAreComplete) {
  SurfaceCase c;
  c.kind = "coincident";
  Random random(1);
  addQuads(c, 300, 3, random, [&](int, int k) { return Point{k % 2 * 1.0, k / 2 * 1.0, 0}; });
  distribute(c, random, sizeOf(comm));
  GlobalSearch global(comm, configOf(c, SearchMethod::paper));
  LocalSearch local(configOf(c, SearchMethod::paper));
  EXPECT_TRUE(checkStep(c, global, local));
}

TEST(SearchTest, SendersAndReceiversAgreeOnPartners) {
  const exec_space space;
  const int rank = rankOf(comm), size = sizeOf(comm);
  for (std::uint64_t seed = 0; seed < 40; ++seed)
    for (const SearchMethod method : both_methods) {
      const SurfaceCase c = makeCase(seed, size);
      const LocalSurface local = localSurface(c, rank);
      SurfaceBoxes boxes;
      RankBoxes rank_boxes;
      GhostingCandidates candidates;
      constructBoxes(space, local.surface, configOf(c, method), boxes);
      exchangeRankBoxes(comm, local.surface, boxes, rank_boxes);
      findPartnersAndCandidates(space, local.surface, boxes, rank_boxes, method, candidates);
      std::vector<int> sends(size * size, 0), receives(size * size, 0);
      for (const int q : candidates.nodes_to_send.ranks)
        ++sends[rank * size + q];
      for (const int q : candidates.faces_to_test.ranks)
        ++receives[q * size + rank];
      allReduce(comm, sends.data(), size * size, MPI_SUM);
      allReduce(comm, receives.data(), size * size, MPI_SUM);
      EXPECT_EQ(sends, receives) << c.name(); // r in Q_snd(q) if and only if q in Q_rcv(r)
      EXPECT_EQ(sends[rank * size + rank], 0);
      for (const int count : sends)
        EXPECT_LE(count, 1); // no duplicates
    }
}

TEST(SearchTest, SentFacesAreTheGhostsOfTheirDestinations) {
  const exec_space space;
  const int rank = rankOf(comm), size = sizeOf(comm);
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    for (const SearchMethod method : both_methods) {
      const SurfaceCase c = makeCase(seed, size);
      const LocalSurface local = localSurface(c, rank);
      GlobalSearch global(comm, configOf(c, method));
      const GhostFaces& ghosts = global.findGhosts(space, local.surface);
      std::vector<std::vector<global_id>> sent(size);
      for (const SentFace& face : global.sentFaces(space, local.surface))
        sent[face.destination].push_back(face.face);
      std::vector<global_id> expected;
      for (const auto& from : exchangeByRank(comm, sent))
        expected.insert(expected.end(), from.begin(), from.end());
      const auto ids = onHost(ghosts.face_ids);
      EXPECT_EQ(std::vector<global_id>(ids.data(), ids.data() + ghosts.count), expected)
          << c.name() << ", " << nameOf(method);
    }
}

std::int64_t reactionOf(global_id face, int rank, int i) {
  return (face * 7919 + rank * 104729 + i * 31) * (i % 2 == 0 ? 1000003 : -1000033);
}

TEST(SearchTest, ReactionsOnGhostsReturnToTheirOwnersExactly) {
  const exec_space space;
  const int rank = rankOf(comm), size = sizeOf(comm);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const SurfaceCase c = makeCase(seed, size);
    const LocalSurface local = localSurface(c, rank);
    GlobalSearch global(comm, configOf(c, SearchMethod::paper));
    const GhostFaces& ghosts = global.findGhosts(space, local.surface);
    const auto ids = onHost(ghosts.face_ids);
    const auto reactions = viewOf<View<std::int64_t* [12]>>(
        static_cast<std::size_t>(ghosts.count), 12,
        [&](auto g, auto i) { return reactionOf(ids(g), rank, static_cast<int>(i)); });
    const auto returned = viewOf<View<std::int64_t* [12]>>(
        local.faces.size(), 12, [](auto, auto i) { return static_cast<std::int64_t>(i); });
    global.returnToOwners(space, reactions, returned);
    space.fence();

    const auto found = onHost(returned);
    std::vector<std::vector<char>> ghosted(size, std::vector<char>(c.faces.size(), 0));
    for (int q = 0; q < size; ++q)
      for (const int f : expectedOnRank(c, localSurface(c, q), q).ghosts)
        ghosted[q][f] = 1;
    for (std::size_t f = 0; f < local.faces.size(); ++f)
      for (int i = 0; i < 12; ++i) {
        std::int64_t expected = i;
        for (int q = 0; q < size; ++q)
          if (ghosted[q][local.faces[f]])
            expected += reactionOf(c.faces[local.faces[f]].id, q, i);
        ASSERT_EQ(found(f, i), expected) << c.name() << ", face " << c.faces[local.faces[f]].id;
      }
  }
}

TEST(SearchTest, AllRanksThrowTheSameMessageForACoordinateThatIsNotFinite) {
  const exec_space space;
  const int rank = rankOf(comm), size = sizeOf(comm);
  SurfaceCase c = makeCase(10, size);
  const double bad_values[] = {std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity()};
  for (std::size_t n = 0; n < c.nodes.size(); n += 17)
    for (const double bad : bad_values) {
      SurfaceCase broken = c;
      (n % 2 == 0 ? broken.nodes[n].x_new : broken.nodes[n].x_old)[n % 3] = bad;
      GlobalSearch search(comm, configOf(c, SearchMethod::paper));
      std::string message = "nothing thrown";
      try {
        search.findGhosts(space, localSurface(broken, rank).surface);
      } catch (const PhysicsError& error) {
        message = error.what();
      }
      EXPECT_EQ(message, broadcast(comm, message)); // rank 0's
      EXPECT_NE(message.find("node " + std::to_string(c.nodes[n].id) + " on rank " +
                             std::to_string(c.nodes[n].sharers.front())),
                std::string::npos)
          << message;
      LocalSearch local(configOf(c, SearchMethod::paper)); // and the search is usable again
      EXPECT_TRUE(checkStep(c, search, local));
    }
}

TEST(SearchTest, DifferentNumbersOfFaceAttributesAreRefusedTogether) {
  const int rank = rankOf(comm), size = sizeOf(comm);
  if (size == 1)
    GTEST_SKIP() << "needs two ranks with faces";
  const exec_space space;
  SurfaceCase c = makeCase(0, size);
  for (std::size_t f = 0; f < c.faces.size(); ++f)
    c.faces[f].rank = static_cast<int>(f) % size;
  for (auto& node : c.nodes) {
    node.sharers.resize(static_cast<std::size_t>(size));
    for (int q = 0; q < size; ++q)
      node.sharers[q] = q;
  }
  LocalSurface local = localSurface(c, rank);
  if (rank == 1)
    local.surface.face_attributes = View<double**>("test", local.faces.size(), 1);
  GlobalSearch search(comm, configOf(c, SearchMethod::paper));
  EXPECT_THROW(search.findGhosts(space, local.surface), InputError);
}

TEST(SearchTest, ToleranceMustBeAFiniteLength) {
  SearchConfig config;
  config.node_tolerance = -1;
  EXPECT_THROW(GlobalSearch(comm, config), InputError);
  config.node_tolerance = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(GlobalSearch(comm, config), InputError);
}

std::atomic<int> num_allocations{0};

TEST(SearchTest, ASteadyStepAllocatesNothing) {
  const exec_space space;
  const SurfaceCase c = makeCase(30, sizeOf(comm));
  const LocalSurface surface = localSurface(c, rankOf(comm));
  GlobalSearch global(comm, configOf(c, SearchMethod::paper));
  LocalSearch local(configOf(c, SearchMethod::paper));
  const auto step = [&] {
    const GhostFaces& ghosts = global.findGhosts(space, surface.surface);
    local.findCandidatePairs(space, surface.surface, ghosts, global.boxes());
  };
  Kokkos::Tools::Experimental::set_allocate_data_callback([](Kokkos_Profiling_SpaceHandle,
                                                             const char*, const void*,
                                                             std::uint64_t) { ++num_allocations; });
  num_allocations = 0;
  step();
  EXPECT_GT(num_allocations, 0); // the first step does, so the count counts
  num_allocations = 0;
  step();
  Kokkos::Tools::Experimental::set_allocate_data_callback(nullptr);
  EXPECT_EQ(num_allocations, 0);
}

} // namespace
} // namespace brickwall::contact::test
