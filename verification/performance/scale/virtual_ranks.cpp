// Phases 1 to 4 of the global search on many virtual ranks in one process: the exchange of rank boxes
// (phase 2) among all of them, by the program's RankTree; boxes, candidates and node boxes (1, 3, 4)
// on a few ranks whose surfaces are built. A rank holds 16 bricks of a wall, or of a pile of many
// layers, cut by recursive bisection. Prints a CSV row for each scene and number of ranks; scale.md
// beside this file explains the columns. Arguments: numbers of ranks.
#include "tests/contact/support/virtual_ranks.hpp"
#include "contact/base/to_device.hpp"
#include "contact/search/cluster/cluster_candidates.hpp"
#include "contact/search/exchange/node_box_exchange.hpp"
#include "verification/performance/benchmarks/benchmark_main.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <vector>

namespace brickwall::contact {
namespace {

using namespace test;

constexpr int n = 8; // elements of a brick: 2n x n x n; a brick is 2 x 1 x 1
constexpr double edge = 1.0 / n, tolerance = 0.05 * edge;
constexpr double bricks_per_rank = 16, volume_of_brick = 2;
constexpr double box_margin = 0.01; // of the longest side, as in exchangeRankBoxes()
constexpr int repetitions = 7;

struct Scene {
  std::string name;
  bool is_wall = true; // one brick deep
  bool is_numbered_at_random = false;
  bool has_stray = false; // one rank's box reaches over all others
};
const std::vector<Scene> scenes = {{"wall", true, false, false},
                                   {"pile", false, false, false},
                                   {"wall, one stray box", true, false, true},
                                   {"wall, ranks at random", true, true, false}};
// Costs that grow with all ranks are not replayed beyond this number.
constexpr int most_ranks_at_random = 4096;

Box domainOf(const Scene& scene, int ranks) {
  const double volume = ranks * bricks_per_rank * volume_of_brick;
  const double side = scene.is_wall ? std::sqrt(volume) : std::cbrt(volume);
  Box domain;
  domain.include(Vec3{0, 0, 0});
  domain.include(Vec3{side, scene.is_wall ? 1 : side, side});
  return domain;
}

bool isIn(const Box& cell, const Vec3& x) {
  for (int d = 0; d < 3; ++d)
    if (x[d] < cell.lower[d] || x[d] >= cell.upper[d])
      return false;
  return true;
}

// The exterior faces of the elements whose centres are in a cell, with their nodes.
class CellSurface {
public:
  explicit CellSurface(const Box& cell) : _cell(cell) {
    int first[3], last[3];
    for (int d = 0; d < 3; ++d) {
      const double length = d == 0 ? 2 : 1;
      first[d] = static_cast<int>(std::floor(cell.lower[d] / length)) - 1;
      last[d] = static_cast<int>(std::ceil(cell.upper[d] / length)) + 1;
    }
    for (int k = first[2]; k < last[2]; ++k)
      for (int j = first[1]; j < last[1]; ++j)
        for (int i = first[0]; i < last[0]; ++i)
          addBrick(i, j, k);
  }

  SweptBoxes onDevice(const exec_space& space) const {
    SweptBoxes surface;
    surface.num_nodes = static_cast<int>(_ids.size());
    surface.num_faces = static_cast<int>(_face_ids.size());
    const auto x = toDevice<View<double* [3]>>(space, "x", _x);
    surface.coordinates_old = surface.coordinates_new = x;
    surface.face_to_nodes = toDevice<View<int* [4]>>(space, "face_to_nodes", _face_to_nodes);
    surface.node_ids = toDevice(space, "node_ids", _ids);
    surface.face_ids = toDevice(space, "face_ids", _face_ids);
    surface.node_is_owned = toDevice(space, "owned", _owned);
    surface.node_body = toDevice(space, "node_body", _bodies);
    surface.face_body = toDevice(space, "face_body", _face_bodies);
    return surface;
  }

private:
  void addBrick(int i, int j, int k) {
    const Vec3 origin{2.0 * i + (k % 2 != 0 ? 1 : 0), 1.0 * j, 1.0 * k};
    constexpr int counts[3] = {2 * n, n, n};
    const global_id brick = ((global_id(k) + 4) * 100000 + j + 4) * 100000 + i + 4;
    std::map<global_id, int> nodes; // of this brick
    for (int d = 0; d < 3; ++d)
      for (int side = 0; side < 2; ++side)
        for (int u = 0; u < counts[(d + 1) % 3]; ++u)
          for (int v = 0; v < counts[(d + 2) % 3]; ++v) {
            int elem[3];
            elem[d] = side * (counts[d] - 1);
            elem[(d + 1) % 3] = u;
            elem[(d + 2) % 3] = v;
            addFace(origin, brick, elem, d, side, nodes);
          }
  }

  void addFace(const Vec3& origin, global_id brick, const int (&elem)[3], int d, int side,
               std::map<global_id, int>& nodes) {
    const Vec3 centre{origin[0] + (elem[0] + 0.5) * edge, origin[1] + (elem[1] + 0.5) * edge,
                      origin[2] + (elem[2] + 0.5) * edge};
    if (!isIn(_cell, centre))
      return;
    constexpr int around[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (int c = 0; c < 4; ++c) {
      int at[3];
      at[d] = elem[d] + side;
      at[(d + 1) % 3] = elem[(d + 1) % 3] + around[side == 1 ? c : 3 - c][0];
      at[(d + 2) % 3] = elem[(d + 2) % 3] + around[side == 1 ? c : 3 - c][1];
      const global_id id = (global_id(at[2]) * 64 + at[1]) * 64 + at[0];
      const auto [it, is_new] = nodes.try_emplace(id, static_cast<int>(_ids.size()));
      if (is_new)
        addNode(origin, brick, id, at);
      _face_to_nodes.push_back(it->second);
    }
    _face_ids.push_back(static_cast<global_id>(_face_ids.size()));
    _face_bodies.push_back(brick);
  }

  // A node belongs to the cell in which it is, if drawn a little into its brick.
  void addNode(const Vec3& origin, global_id brick, global_id id, const int (&at)[3]) {
    constexpr double middle[3] = {1, 0.5, 0.5};
    Vec3 inside;
    for (int d = 0; d < 3; ++d) {
      const double x = at[d] * edge;
      _x.push_back(origin[d] + x);
      inside[d] = origin[d] + x + 1e-6 * (middle[d] - x);
    }
    _ids.push_back(brick * 64 * 64 * 64 + id);
    _bodies.push_back(brick);
    _owned.push_back(isIn(_cell, inside));
  }

  Box _cell;
  std::vector<double> _x;
  std::vector<global_id> _ids, _bodies, _face_ids, _face_bodies;
  std::vector<int> _face_to_nodes;
  std::vector<unsigned char> _owned;
};

template <class Work>
double medianSeconds(const Work& work) {
  std::vector<double> seconds;
  for (int i = 0; i < repetitions; ++i) {
    const double begin = MPI_Wtime();
    work();
    seconds.push_back(MPI_Wtime() - begin);
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds[repetitions / 2];
}

// Means over the ranks that are built.
struct LocalCosts {
  double faces = 0, nodes_sent = 0, blocks_tested = 0, partners = 0;
  double boxes_seconds = 0, candidates_seconds = 0, node_boxes_seconds = 0; // phases 1, 3, 4

  void addRank(const exec_space& space, const Box& cell, const RankRecord& own,
               const std::vector<RankRecord>& others, double share) {
    const SweptBoxes surface = CellSurface(cell).onDevice(space);
    SearchConfig config;
    config.node_tolerance = config.face_tolerance = tolerance;
    RankBoxes boxes;
    for (const RankRecord& other : others) {
      if (own.node_box.overlaps(other.face_box))
        boxes.near_nodes.add(other.rank, other.face_box);
      if (own.face_box.overlaps(other.node_box))
        boxes.near_faces.add(other.rank, other.node_box);
    }
    SurfaceClusters clusters;
    clusters.update(space, surface, config); // sorts and allocates
    boxes_seconds += share * medianSeconds([&] { clusters.update(space, surface, config); });
    ClusterCandidates found;
    findPartnersAndCandidates(space, clusters, boxes, found);
    candidates_seconds +=
        share * medianSeconds([&] { findPartnersAndCandidates(space, clusters, boxes, found); });
    faces += share * surface.num_faces;
    partners += share * static_cast<double>(others.size());
    nodes_sent += share * static_cast<double>(found.nodes_to_send.size());
    blocks_tested += share * static_cast<double>(found.blocks_to_test.size());
    // All messages as one to this process itself.
    PartnerLists& lists = found.nodes_to_send;
    lists.offsets = {0, lists.size()};
    lists.ranks = {0};
    PartnerMessages messages;
    node_boxes_seconds +=
        share * medianSeconds([&] {
          exchangeNodeBoxes(space, MPI_COMM_SELF, surface, tolerance, lists, {0}, messages);
        });
  }
};

void measure(const Scene& scene, int ranks) {
  const exec_space space;
  std::vector<Box> cells = bisectedCells(domainOf(scene, ranks), ranks);
  if (scene.is_numbered_at_random)
    std::shuffle(cells.begin(), cells.end(), std::mt19937_64(1));
  double longest = 0;
  for (int d = 0; d < 3; ++d)
    longest = std::max(longest, cells[0].upper[d] - cells[0].lower[d]);
  std::vector<RankRecord> records = recordsOf(cells, 0.5 * edge + tolerance + box_margin * longest);
  const int stray = ranks / 3;
  if (scene.has_stray)
    records[std::size_t(stray)].face_box = domainOf(scene, ranks);
  const double begin = MPI_Wtime();
  const Replay replay = replayExchange(records);
  const double seconds = (MPI_Wtime() - begin) / ranks;

  LocalCosts local;
  const std::vector<int> built = {0, ranks / 2, ranks / 4, 2 * ranks / 3, 5 * ranks / 7};
  for (const int q : built)
    local.addRank(space, cells[std::size_t(q)], records[std::size_t(q)],
                  replay.partners[std::size_t(q)], 1.0 / static_cast<double>(built.size()));
  const auto of = [&](auto count) { return overRanks(replay, count); };
  std::printf(
      "\"%s\",%d,%.0f,%.2f,%.0f,%.1f,%.0f,%.1f,%.0f,%.0f,%.3f,%.0f,%.1f,%.1f,%.1f,%.0f,%.1f\n",
      scene.name.c_str(), ranks, of(&ExchangeCounts::messages).max,
      of(&ExchangeCounts::partners).mean, of(&ExchangeCounts::partners).max,
      of(&ExchangeCounts::bytes).mean, of(&ExchangeCounts::bytes).max,
      of(&ExchangeCounts::box_tests).mean, of(&ExchangeCounts::box_tests).max, local.faces,
      1e6 * seconds, local.blocks_tested, 1e6 * local.boxes_seconds, 1e6 * local.candidates_seconds,
      local.partners, 8 * box_words * local.nodes_sent, 1e6 * local.node_boxes_seconds);
  std::fflush(stdout);
}

void measureAll(const std::vector<int>& numbers) {
  std::printf("scene,ranks,messages,partners,partners_max,tree_bytes,tree_bytes_max,box_tests,"
              "box_tests_max,faces,tree_us,blocks_tested,boxes_us,candidates_us,partners_built,"
              "node_box_bytes,node_boxes_us\n");
  for (const Scene& scene : scenes)
    for (const int ranks : numbers)
      if (!scene.is_numbered_at_random || ranks <= most_ranks_at_random)
        measure(scene, ranks);
}

} // namespace
} // namespace brickwall::contact

int main(int argc, char** argv) {
  std::vector<int> numbers;
  for (int i = 1; i < argc; ++i)
    if (const int ranks = std::atoi(argv[i]); ranks > 0)
      numbers.push_back(ranks);
  if (numbers.empty())
    numbers = {64, 256, 1000, 4096, 16384, 65536, 100000};
  return brickwall::benchmarkMain(argc, argv, [&] { brickwall::contact::measureAll(numbers); });
}
