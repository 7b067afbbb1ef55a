// A wall that moves for many steps with one search object: refitted boxes give the results of a new
// search, also when bricks have moved away and the order has degraded; ten thousand steps need no
// more memory than the first ones.
#include "contact/search/local_search.hpp"
#include "tests/contact/search/host_rows.hpp"
#include "tests/contact/search/search_checks.hpp"
#include "tests/support/communicator.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include <unistd.h>

namespace brickwall::contact::test {
namespace {

SurfaceCase makeWall(std::uint64_t seed) {
  SurfaceCase c;
  Random random(seed);
  c.kind = "moving wall";
  c.seed = seed;
  addWall(c, random, seed % 2 == 0 ? 12 : 4);
  c.drop_same_body = seed > 2;
  moveNodes(c, random, 0.0025, 0);
  c.node_tolerance = c.face_tolerance = 0.0125;
  distribute(c, random, sizeOf(comm));
  return c;
}

// x^n := x^{n+1}; every brick moves on in its own direction, by at most `speed` along an axis.
void drift(SurfaceCase& c, double speed) {
  for (CaseNode& node : c.nodes) {
    node.x_old = node.x_new;
    Random way(c.seed + 31 * static_cast<std::uint64_t>(node.body));
    for (double& x : node.x_new)
      x += way.real(-speed, speed);
  }
}

// [node] global ids of the listed faces, in order.
std::map<int, std::vector<global_id>> rowsByNode(const Surface& surface, const GhostFaces& ghosts,
                                                 const CandidatePairs& pairs) {
  const HostRows rows(pairs);
  const auto own_ids = toHost(surface.face_ids);
  const auto ghost_ids = toHost(ghosts.face_ids);
  std::map<int, std::vector<global_id>> by_node;
  for (int r = 0; r < pairs.num_rows; ++r) {
    auto& ids = by_node[rows.node(r)];
    for (const int face : rows.faces(r))
      ids.push_back(face < surface.num_faces ? own_ids(face) : ghost_ids(face - surface.num_faces));
  }
  return by_node;
}

struct Searches {
  GlobalSearch global;
  LocalSearch local;
  explicit Searches(const SearchConfig& config) : global(comm, config), local(global) {}
  const CandidatePairs& search(const exec_space& space, const Surface& surface) {
    global.findGhosts(space, surface);
    return local.findCandidatePairs(space, surface);
  }
};

TEST(MovingWallTest, RefittedTreesFindWhatNewOnesFind) {
  const exec_space space;
  std::int64_t pairs_found = 0, orderings = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SurfaceCase c = makeWall(seed);
    const SearchConfig config = configOf(c, SearchMethod::cluster);
    const LocalSurface kept = localSurface(c, rankOf(comm));
    Searches lasting(config);
    for (int step = 0; step < 60; ++step) {
      drift(c, step < 40 ? 0.05 : 0.0005); // slowly: most clusters hit what they hit before
      const Surface now = localSurface(c, rankOf(comm)).surface;
      Surface moved = kept.surface; // the same Views but for the coordinates
      moved.coordinates_old = now.coordinates_old;
      moved.coordinates_new = now.coordinates_new;
      Searches anew(config);
      const CandidatePairs& pairs = lasting.search(space, moved);
      const CandidatePairs& expected = anew.search(space, moved);
      space.fence();
      pairs_found += pairs.count;
      ASSERT_TRUE(okOnAllRanks(comm, rowsByNode(moved, lasting.global.ghosts(), pairs) ==
                                         rowsByNode(moved, anew.global.ghosts(), expected)))
          << c.name() << ", step " << step;
    }
    orderings += lasting.global.numOrderings();
  }
  EXPECT_GT(allReduce(comm, pairs_found, MPI_SUM), 10000);
  EXPECT_GT(allReduce(comm, orderings, MPI_SUM),
            4 * sizeOf(comm)); // bricks have separated: the surface is sorted again
}

// [block] the nodes of its rows and their faces.
std::vector<std::vector<int>> blocksOf(const CandidatePairs& pairs) {
  const HostRows rows(pairs);
  std::vector<std::vector<int>> blocks((pairs.num_rows + CandidatePairs::rows_per_block - 1) /
                                       CandidatePairs::rows_per_block);
  for (int r = 0; r < pairs.num_rows; ++r) {
    auto& block = blocks[r / CandidatePairs::rows_per_block];
    block.push_back(-1 - rows.node(r));
    for (const int face : rows.faces(r))
      block.push_back(face);
  }
  return blocks;
}

TEST(MovingWallTest, BlocksThatAreNotMarkedAsChangedHaveTheRowsThatTheyHad) {
  const exec_space space;
  std::int64_t kept = 0, changed = 0;
  for (const double speed : {0.0005, 0.05}) {
    SurfaceCase c = makeWall(5);
    const LocalSurface first = localSurface(c, rankOf(comm));
    Searches lasting(configOf(c, SearchMethod::cluster));
    std::vector<std::vector<int>> last;
    std::int64_t version = 0;
    for (int step = 0; step < 30; ++step) {
      drift(c, speed);
      const Surface now = localSurface(c, rankOf(comm)).surface;
      Surface moved = first.surface;
      moved.coordinates_old = now.coordinates_old;
      moved.coordinates_new = now.coordinates_new;
      const CandidatePairs& pairs = lasting.search(space, moved);
      space.fence();
      const auto blocks = blocksOf(pairs);
      const auto marks = toHost(pairs.changed);
      ASSERT_GT(pairs.version, version);
      for (std::size_t b = 0; b < blocks.size() && pairs.version == version + 1; ++b) {
        kept += marks(b) == 0;
        changed += marks(b) != 0;
        if (marks(b) == 0) {
          ASSERT_EQ(blocks[b], last[b]) << "block " << b << ", step " << step;
        }
      }
      last = blocks;
      version = pairs.version;
    }
  }
  EXPECT_GT(allReduce(comm, kept, MPI_SUM), 100);
  EXPECT_GT(allReduce(comm, changed, MPI_SUM), 100);
}

// Bytes of existing Views, counted by callbacks of Kokkos.
std::int64_t live_bytes = 0, most_live_bytes = 0;

void countAllocation(Kokkos_Profiling_SpaceHandle, const char*, const void*, std::uint64_t size) {
  live_bytes += static_cast<std::int64_t>(size);
  most_live_bytes = std::max(most_live_bytes, live_bytes);
}
void countDeallocation(Kokkos_Profiling_SpaceHandle, const char*, const void*, std::uint64_t size) {
  live_bytes -= static_cast<std::int64_t>(size);
}

std::int64_t residentBytes() {
  std::int64_t total = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

// Bricks oscillate about their initial positions, each with its own phase; the period is 500 steps.
void swing(const exec_space& space, int step, const View<const double* [3]>& rest,
           const View<const global_id*>& body, Surface& surface, const View<double* [3]>& other) {
  const View<double* [3]> x = other;
  constexpr double pi = 3.14159265358979;
  Kokkos::parallel_for(
      "test::swing", rangePolicy(space, surface.num_nodes), KOKKOS_LAMBDA(const std::int64_t node) {
        for (int d = 0; d < 3; ++d)
          x(node, d) = rest(node, d) +
                       0.3 * std::sin(2 * pi * (step / 500.0 + 0.37 * body(node) + 0.21 * d));
      });
}

TEST(MovingWallTest, TenThousandStepsNeedNoMoreMemoryThanTheFirst) {
  constexpr int num_steps = 10000, warmup = 2000;
  constexpr std::int64_t allowed = 1 << 20; // for MPI and the C library
  const exec_space space;
  const SurfaceCase c = makeWall(7);
  const LocalSurface local = localSurface(c, rankOf(comm));
  Surface surface = local.surface;
  View<double*[3]> a("test::x", surface.num_nodes), b("test::x", surface.num_nodes);
  Kokkos::deep_copy(a, surface.coordinates_new);
  const auto rest = surface.coordinates_new;
  Searches lasting(configOf(c, SearchMethod::cluster));
  Kokkos::Tools::Experimental::set_allocate_data_callback(countAllocation);
  Kokkos::Tools::Experimental::set_deallocate_data_callback(countDeallocation);
  std::int64_t most_at_first = 0, resident_at_first = 0, pairs = 0;
  for (int step = 0; step < num_steps; ++step) {
    swing(space, step, rest, surface.node_body, surface, b);
    surface.coordinates_old = a;
    surface.coordinates_new = b;
    pairs += lasting.search(space, surface).count;
    std::swap(a, b);
    if (step == warmup) {
      most_at_first = most_live_bytes;
      resident_at_first = residentBytes();
    }
  }
  Kokkos::Tools::Experimental::set_allocate_data_callback(nullptr);
  Kokkos::Tools::Experimental::set_deallocate_data_callback(nullptr);
  EXPECT_GT(allReduce(comm, pairs, MPI_SUM), num_steps);
  EXPECT_EQ(most_live_bytes, most_at_first);
  EXPECT_LE(residentBytes() - resident_at_first, allowed);
}

} // namespace
} // namespace brickwall::contact::test
