// Global and local search against a brute-force evaluation of their definition, on random surfaces;
// no allocation in a steady step. ghost_search_test.cpp tests what concerns the global search alone.
#include "contact/search/local_search.hpp"
#include "tests/contact/search/host_rows.hpp"
#include "tests/contact/search/search_checks.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/communicator.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace brickwall::contact::test {
namespace {

using brickwall::testing::allocationsOf;
using brickwall::testing::no_allocations;

// Corners near a lattice, each coordinate off by at most two units in the last place: boxes barely
// touch, or barely do not.
void addTouching(SurfaceCase& c, Random& random, double offset, double spacing) {
  addQuads(c, 40 + random.below(80), 12, random, [&](int q, int k) {
    Random at(static_cast<std::uint64_t>(q) + 1000 * c.seed);
    Point x{};
    for (int d = 0; d < 3; ++d) {
      x[d] = offset + spacing * (at.below(4) + (d < 2 ? (k + d) / 2 % 2 : 0));
      for (int ulps = random.below(3); ulps > 0; --ulps)
        x[d] = std::nextafter(x[d], random.chance(0.5) ? HUGE_VAL : -HUGE_VAL);
    }
    return x;
  });
}

// Quadrilaterals of sizes from 1e-30 to 1e30 about common points; one in four is a point itself.
void addUnlikeSizes(SurfaceCase& c, Random& random, double offset) {
  addQuads(c, 60 + random.below(60), 9, random, [&](int q, int) {
    Random at(static_cast<std::uint64_t>(q) + 1000 * c.seed);
    const double size = q % 4 == 0 ? 0 : std::pow(10, at.below(61) - 30);
    Point x{};
    for (int d = 0; d < 3; ++d)
      x[d] = offset + 0.25 * at.below(2) + size * random.real(-1, 1);
    return x;
  });
}

// Coordinates of 0, -0 and the smallest numbers, which floats round to 0.
void addTinyNumbers(SurfaceCase& c, Random& random) {
  const double tiny[] = {0, -0.0, 5e-324, -5e-324, 1e-310, -1e-310, 1e-45, -1e-45, 2e-38};
  addQuads(c, 60, 7, random, [&](int, int) {
    return Point{tiny[random.below(9)], tiny[random.below(9)], tiny[random.below(9)]};
  });
  c.node_tolerance = random.chance(0.5) ? 0 : 5e-324;
}

// Whole bricks in the same place, and half as far again.
void addBricksInOnePlace(SurfaceCase& c, Random& random, double offset) {
  for (int body = 0; body < 6; ++body) {
    const double x = offset + (body % 3 == 2 ? 0.5 : 0), size = 1 + body / 3;
    const int n = 1 + random.below(3);
    addBrick(c, body, {x, offset, offset}, {x + size, offset + size, offset + size}, {n, n, n});
  }
}

// Nodes that cross the range of floats, and most of that of doubles, within a step.
void addFastNodes(SurfaceCase& c, Random& random) {
  addWall(c, random, 1);
  const double speeds[] = {0, 1e-300, 1, 1e30, 1e39, -1e39, 1e300, -1e300};
  for (auto& node : c.nodes) {
    Random at(static_cast<std::uint64_t>(node.body) + 1000 * c.seed);
    for (int d = 0; d < 3; ++d)
      node.x_new[d] += speeds[at.below(8)];
  }
}

// Surfaces that are difficult for a search in floats: boxes that are equal in floats but not in
// doubles, identical boxes, one box that overlaps all others, numbers beyond the range of floats.
SurfaceCase makeHardCase(std::uint64_t seed, int num_ranks) {
  SurfaceCase c;
  Random random(seed + 5000);
  c.seed = seed;
  switch (seed % 11) {
  case 0:
    c.kind = "touching to the last place";
    addTouching(c, random, 0, 0.5);
    break;
  case 1:
    c.kind = "touching to the last place, inflated";
    addTouching(c, random, 1, 0.5);
    c.node_tolerance = random.chance(0.5) ? 0.25 : 0.1;
    c.face_tolerance = random.chance(0.5) ? 0.25 : 0.15;
    break;
  case 2: { // far from the origin, where a float is as wide as the mesh
    c.kind = "touching, far out";
    const double offset = random.chance(0.5) ? 1e9 : -3e13;
    addTouching(c, random, offset, 0.5);
    break;
  }
  case 3: {
    c.kind = "jittered wall, far out";
    addWall(c, random, 1 + random.below(2));
    moveNodes(c, random, 0.01, 0.005);
    for (auto& node : c.nodes)
      for (int d = 0; d < 3; ++d) {
        node.x_old[d] += 1e7 * (d - 1.5);
        node.x_new[d] += 1e7 * (d - 1.5);
      }
    c.node_tolerance = 0.02;
    c.face_tolerance = 0.03;
    break;
  }
  case 4:
    c.kind = "all the same";
    addQuads(c, 200, 5, random, [](int, int k) { return Point{k % 2 * 1.0, k / 2 * 1.0, 0.1}; });
    break;
  case 5:
    c.kind = "unlike sizes";
    addUnlikeSizes(c, random, random.chance(0.5) ? 0 : 1e9);
    c.node_tolerance = random.chance(0.5) ? 1e-9 : 0;
    break;
  case 6:
    c.kind = "tiny numbers";
    addTinyNumbers(c, random);
    break;
  case 7:
    c.kind = "bricks in one place";
    addBricksInOnePlace(c, random, random.chance(0.5) ? 0 : -1e9);
    c.face_tolerance = random.chance(0.5) ? 0 : 0x1p-20;
    break;
  case 8:
    c.kind = "fast nodes";
    addFastNodes(c, random);
    break;
  case 9: // tolerances far beyond the surface
    c.kind = "huge tolerances";
    addWall(c, random, 1);
    c.node_tolerance = random.chance(0.5) ? 1e39 : 1e10;
    c.face_tolerance = random.chance(0.5) ? 1e300 : 1e10;
    break;
  default: { // one face over all others
    c.kind = "one huge box";
    addWall(c, random, 1);
    moveNodes(c, random, 0.01, 0.005);
    std::array<int, 4> corners{};
    for (int k = 0; k < 4; ++k)
      corners[k] =
          addNode(c, 9999, {k % 2 == 0 ? -50. : 50., k / 2 == 0 ? -50. : 50., 50. - k * 30});
    addFace(c, 9999, corners);
    c.node_tolerance = c.face_tolerance = 0.025;
    break;
  }
  }
  distribute(c, random, num_ranks);
  return c;
}

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
  const GhostFaces& ghosts = global.launchGhosts(space, local.surface);
  const CandidatePairs& pairs = local_search.findCandidatePairs(space, local.surface);
  global.finishGhosts(space, local.surface);
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
void checkCases(std::uint64_t num_seeds, const Make& make) {
  Counts counts;
  for (std::uint64_t seed = 0; seed < num_seeds; ++seed)
    for (const SearchMethod method : all_methods) {
      const SurfaceCase c = make(seed, sizeOf(comm));
      GlobalSearch global(comm, configOf(c, method));
      LocalSearch local(global);
      ASSERT_TRUE(checkStep(c, global, local, &counts)) << c.name();
    }
  // The cases do have pairs and ghosts.
  EXPECT_GT(allReduce(comm, counts.pairs, MPI_SUM), 100000);
  if (sizeOf(comm) > 1) {
    EXPECT_GT(allReduce(comm, counts.ghosts, MPI_SUM), 10000);
  }
}

TEST(SearchTest, GhostsAndPairsEqualBruteForceOnRandomSurfaces) {
  checkCases(260, makeCase);
}

// Own faces and ghosts: also on one rank.
TEST(SearchTest, BoxesEqualInFloatsAreDecidedInDoubles) {
  checkCases(110, makeHardCase);
}

TEST(SearchTest, BuffersOfEarlierStepsDoNotShowInLaterOnes) {
  SurfaceCase first = makeCase(0, sizeOf(comm));
  for (const SearchMethod method : all_methods) {
    GlobalSearch global(comm, configOf(first, method));
    LocalSearch local(global);
    for (std::uint64_t seed = 0; seed < 30; ++seed) { // large, small and empty cases alternate
      SurfaceCase c =
          seed % 2 == 0 ? makeCase(seed / 2, sizeOf(comm)) : makeHardCase(seed / 2, sizeOf(comm));
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

TEST(SearchTest, ASteadyStepAllocatesNothing) {
  const exec_space space;
  const SurfaceCase c = makeCase(30, sizeOf(comm));
  const LocalSurface surface = localSurface(c, rankOf(comm));
  for (const SearchMethod method : {SearchMethod::cluster, SearchMethod::paper}) {
    GlobalSearch global(comm, configOf(c, method));
    LocalSearch local(global);
    const auto step = [&] {
      global.findGhosts(space, surface.surface);
      local.findCandidatePairs(space, surface.surface);
    };
    EXPECT_NE(allocationsOf(step), no_allocations); // the first step allocates: they are seen
    EXPECT_EQ(allocationsOf(step), no_allocations) << nameOf(method);
  }
}

} // namespace
} // namespace brickwall::contact::test
