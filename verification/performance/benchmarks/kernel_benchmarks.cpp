// Times the kernels of the search one by one on the walls W(2) and W(8) with Google Benchmark, on
// one rank and OMP_NUM_THREADS threads. Items are faces, nodes, keys or pairs, according to the
// name. Results are checked: a wrong one fails the run.
#include "contact/base/mpi.hpp"
#include "contact/search/cluster/cluster_pairs.hpp"
#include "contact/search/exchange/face_migration.hpp"
#include "contact/search/spatial/bvh_query.hpp"
#include "contact/surface/construct_boxes.hpp"
#include "verification/performance/benchmarks/bench_wall.hpp"

#include <benchmark/benchmark.h>

#include <iostream>
#include <map>
#include <random>

namespace {

using namespace brickwall;
using namespace brickwall::contact;
using brickwall::peers::movingWall;
using brickwall::peers::wallSearch;
using brickwall::peers::wallSurface;

bool all_right = true;

// The moving wall after two steps, with the boxes and the tree that later kernels read.
struct Wall {
  explicit Wall(int n)
      : config(wallSearch(n, SearchMethod::paper)),
        moving(movingWall(space, MPI_COMM_SELF, n, wallSurface(MPI_COMM_SELF, n))) {
    moving.move(space, 0);
    moving.move(space, 1);
    surface = moving.surface();
    constructBoxes(space, surface, config, boxes);
    buildTree(space, boxes.face_boxes, surface.num_faces, boxes.face_box, tree);
    space.fence();
  }

  exec_space space;
  SearchConfig config;
  miniapp::SearchSurface moving;
  Surface surface;
  SurfaceBoxes boxes;
  Bvh tree;
  GhostFaces no_ghosts;
};

std::map<int, std::unique_ptr<Wall>> walls; // built once, cleared before Kokkos ends

Wall& wallOf(const benchmark::State& state) {
  auto& wall = walls[static_cast<int>(state.range(0))];
  if (!wall)
    wall = std::make_unique<Wall>(static_cast<int>(state.range(0)));
  return *wall;
}

void expect(benchmark::State& state, bool right, const char* what) {
  if (right)
    return;
  all_right = false;
  state.SkipWithError(what);
}

// Runs `work` once for its buffers, then in every iteration; fences.
template <class Work>
void repeat(benchmark::State& state, const exec_space& space, std::int64_t items,
            const Work& work) {
  work();
  space.fence();
  for (auto _ : state) {
    work();
    space.fence();
  }
  state.SetItemsProcessed(state.iterations() * items);
}

// Accepts every overlapping face of a node, its own among them: the cost of the traversal alone.
struct OverlapsFace {
  View<const Box*> node_boxes, face_boxes;
  KOKKOS_INLINE_FUNCTION OverlapsRow operator()(int node) const {
    return {node_boxes(node), face_boxes.data()};
  }
};

void paperBoxes(benchmark::State& state) {
  Wall& wall = wallOf(state);
  repeat(state, wall.space, wall.surface.num_faces,
         [&] { constructBoxes(wall.space, wall.surface, wall.config, wall.boxes); });
}

void paperTree(benchmark::State& state) {
  Wall& wall = wallOf(state);
  Bvh tree;
  repeat(state, wall.space, wall.surface.num_faces, [&] {
    buildTree(wall.space, wall.boxes.face_boxes, wall.surface.num_faces, wall.boxes.face_box, tree);
  });
}

std::int64_t queryAllNodes(Wall& wall, QueryOrder& order, QueryResults& results) {
  const BoxOfRow box_of{wall.boxes.node_boxes};
  sortQueries(wall.space, box_of, wall.surface.num_nodes, wall.boxes.face_box, order);
  return queryTree(wall.space, "benchmark::query", wall.tree, wall.surface.num_nodes, box_of,
                   OverlapsFace{wall.boxes.node_boxes, wall.boxes.face_boxes}, &order, results);
}

void paperQuery(benchmark::State& state) {
  Wall& wall = wallOf(state);
  QueryOrder order;
  QueryResults results;
  std::int64_t pairs = queryAllNodes(wall, order, results);
  repeat(state, wall.space, pairs, [&] { pairs = queryAllNodes(wall, order, results); });
}

void clusterOrder(benchmark::State& state) {
  Wall& wall = wallOf(state);
  int num_clusters = 0;
  repeat(state, wall.space, wall.surface.num_faces,
         [&] { num_clusters = orderSurface(wall.space, wall.surface, true).num_clusters; });
  expect(state, num_clusters * cluster_size >= wall.surface.num_nodes, "nodes are missing");
}

void clusterRefit(benchmark::State& state) {
  Wall& wall = wallOf(state);
  SurfaceClusters clusters;
  repeat(state, wall.space, wall.surface.num_faces,
         [&] { clusters.update(wall.space, wall.surface, wall.config); });
  expect(state, clusters.numOrderings() == 1, "the surface was ordered again");
}

void clusterPairs(benchmark::State& state) {
  Wall& wall = wallOf(state);
  SurfaceClusters clusters;
  clusters.update(wall.space, wall.surface, wall.config);
  ClusterPairs search;
  CandidatePairs pairs;
  const auto find = [&] {
    search.find(wall.space, wall.surface, wall.no_ghosts, clusters, wall.config, pairs);
  };
  find();
  repeat(state, wall.space, pairs.count, find);
  QueryOrder order;
  QueryResults results;
  const std::int64_t own =
      4 * std::int64_t(wall.surface.num_faces); // the search excludes the faces of a node
  expect(state, pairs.count + own == queryAllNodes(wall, order, results), "other pairs");
}

void radixSort(benchmark::State& state) {
  Wall& wall = wallOf(state);
  const std::int64_t n = wall.surface.num_faces;
  std::vector<std::uint64_t> random(static_cast<std::size_t>(n));
  std::mt19937_64 engine(1);
  for (auto& key : random)
    key = engine() >> (64 - morton_bits);
  View<std::uint64_t*> keys("benchmark::keys", 0);
  copyToDevice(wall.space, random, keys);
  SortedKeys sorted;
  sorted.grow(wall.space, n);
  const auto sort = [&] {
    const auto to = sorted.keys;
    Kokkos::parallel_for(
        "benchmark::shuffledKeys", rangePolicy(wall.space, n),
        KOKKOS_LAMBDA(const std::int64_t i) { to(i) = keys(i); });
    sortByKey(wall.space, n, morton_bits, sorted);
  };
  repeat(state, wall.space, n, sort);
  copyToHost(wall.space, sorted.keys, n, random);
  expect(state, std::is_sorted(random.begin(), random.end()), "keys are not sorted");
}

// Packs all faces, sends them to this rank itself, unpacks them.
void migrateToSelf(benchmark::State& state) {
  Wall& wall = wallOf(state);
  const int n = wall.surface.num_faces;
  PartnerLists faces;
  faces.ranks = {0};
  faces.offsets = {0, n};
  std::vector<int> all(static_cast<std::size_t>(n));
  for (int face = 0; face < n; ++face)
    all[face] = face;
  copyToDevice(wall.space, all, faces.rows);
  FaceMigration migration;
  repeat(state, wall.space, n, [&] {
    migrateFaces(wall.space, MPI_COMM_SELF, wall.surface, faces, {0}, 0, false, migration);
  });
  expect(state, migration.ghosts.count == n, "faces were lost");
}

void onWalls(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("n")->Arg(2)->Arg(8)->UseRealTime()->Unit(benchmark::kMillisecond);
}

BENCHMARK(paperBoxes)->Apply(onWalls);
BENCHMARK(paperTree)->Apply(onWalls);
BENCHMARK(paperQuery)->Apply(onWalls);
BENCHMARK(clusterOrder)->Apply(onWalls);
BENCHMARK(clusterRefit)->Apply(onWalls);
BENCHMARK(clusterPairs)->Apply(onWalls);
BENCHMARK(radixSort)->Apply(onWalls);
BENCHMARK(migrateToSelf)->Apply(onWalls);

} // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv))
    return 2;
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  Kokkos::initialize();
  std::size_t num_run = 0;
  try {
    num_run = benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& error) {
    std::cerr << "kernel_benchmarks: " << error.what() << '\n';
    all_right = false;
  }
  walls.clear();
  benchmark::Shutdown();
  Kokkos::finalize();
  MPI_Finalize();
  return all_right && num_run > 0 ? 0 : 1;
}
