// The global search on many virtual ranks in one process: the exchange of rank boxes (phase 2)
// among all of them, by the program's RankTree; boxes, candidates, node boxes and faces to send (1,
// 3, 4, 5) on a few ranks whose surfaces are built with those of their partners. Prints a CSV row
// for each scene and number of ranks; README.md beside this file explains the columns.
//   contact_virtual_ranks weak RANKS...           16 bricks of W(8) a rank
//   contact_virtual_ranks wall N FACTOR RANKS...  the wall W(N) with FACTOR times the bricks along and up
#include "tests/contact/support/virtual_ranks.hpp"
#include "contact/base/to_device.hpp"
#include "contact/search/cluster/block_ghost_search.hpp"
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
#include <utility>
#include <vector>

namespace brickwall::contact {
namespace {

using namespace test;

constexpr double bricks_per_rank = 16, volume_of_brick = 2; // a brick is 2 x 1 x 1
constexpr double box_margin = 0.01; // of the longest side, as in exchangeRankBoxes()
constexpr int repetitions = 7;
constexpr int num_counted = 200; // ranks whose faces are counted

struct Scene {
  std::string name;
  int n = 8; // a brick has 2n x n x n elements
  Box domain;
  bool is_numbered_at_random = false;
  bool has_stray = false; // one rank's box reaches over all others
  int along = 0, up = 0; // bricks; 0: as far as the domain reaches

  double edge() const { return 1.0 / n; }
  double tolerance() const { return 0.05 * edge(); }
};

Box boxOf(double x, double y, double z) {
  Box box;
  box.include(Vec3{0, 0, 0});
  box.include(Vec3{x, y, z});
  return box;
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
  CellSurface(const Box& cell, const Scene& scene) : _cell(cell), _n(scene.n), _edge(scene.edge()) {
    int first[3], last[3];
    for (int d = 0; d < 3; ++d) {
      const double length = d == 0 ? 2 : 1;
      first[d] = static_cast<int>(std::floor(cell.lower[d] / length)) - 1;
      last[d] = static_cast<int>(std::ceil(cell.upper[d] / length)) + 1;
    }
    for (int k = first[2]; k < last[2]; ++k)
      for (int j = first[1]; j < last[1]; ++j)
        for (int i = first[0]; i < last[0]; ++i)
          if (scene.along == 0 || (i >= 0 && i < scene.along && j == 0 && k >= 0 && k < scene.up))
            addBrick(i, j, k);
  }

  int numFaces() const { return static_cast<int>(_face_ids.size()); }

  SweptBoxes onDevice(const exec_space& space) const {
    SweptBoxes surface;
    surface.num_nodes = static_cast<int>(_ids.size());
    surface.num_faces = numFaces();
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
  static Box boxFrom(const Vec3& origin) {
    Box box;
    box.include(origin);
    box.include(Vec3{origin[0] + 2, origin[1] + 1, origin[2] + 1});
    return box;
  }

  void addBrick(int i, int j, int k) {
    const Vec3 origin{2.0 * i + (k % 2 != 0 ? 1 : 0), 1.0 * j, 1.0 * k};
    const int counts[3] = {2 * _n, _n, _n};
    if (!_cell.overlaps(boxFrom(origin)))
      return;
    const global_id brick = ((global_id(k) + 4) * 2000 + j + 4) * 2000 + i + 4;
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
    const Vec3 centre{origin[0] + (elem[0] + 0.5) * _edge, origin[1] + (elem[1] + 0.5) * _edge,
                      origin[2] + (elem[2] + 0.5) * _edge};
    if (!isIn(_cell, centre))
      return;
    constexpr int around[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (int c = 0; c < 4; ++c) {
      int at[3];
      at[d] = elem[d] + side;
      at[(d + 1) % 3] = elem[(d + 1) % 3] + around[side == 1 ? c : 3 - c][0];
      at[(d + 2) % 3] = elem[(d + 2) % 3] + around[side == 1 ? c : 3 - c][1];
      const global_id id = (global_id(at[2]) * 256 + at[1]) * 256 + at[0];
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
      const double x = at[d] * _edge;
      _x.push_back(origin[d] + x);
      inside[d] = origin[d] + x + 1e-6 * (middle[d] - x);
    }
    _ids.push_back(brick * 256 * 256 * 256 + id);
    _bodies.push_back(brick);
    _owned.push_back(isIn(_cell, inside));
  }

  Box _cell;
  int _n;
  double _edge;
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

// A rank that is built: its surface and what phases 1 and 3 find for it.
struct BuiltRank {
  SweptBoxes surface;
  SearchConfig config;
  SurfaceClusters clusters;
  RankBoxes boxes;
  ClusterCandidates found;

  BuiltRank(const exec_space& space, const Scene& scene, const Box& cell, const RankRecord& own,
            const std::vector<RankRecord>& others)
      : surface(CellSurface(cell, scene).onDevice(space)) {
    config.node_tolerance = config.face_tolerance = scene.tolerance();
    for (const RankRecord& other : others) {
      if (own.node_box.overlaps(other.face_box))
        boxes.near_nodes.add(other.rank, other.face_box);
      if (own.face_box.overlaps(other.node_box))
        boxes.near_faces.add(other.rank, other.node_box);
    }
    clusters.update(space, surface, config); // sorts and allocates
    findPartnersAndCandidates(space, clusters, boxes, found);
  }

  // Phase 4 with rows [first, last) of the nodes to send as one message to this process itself.
  void sendNodeBoxes(const exec_space& space, std::int64_t first, std::int64_t last,
                     PartnerMessages& messages) const {
    PartnerLists list;
    list.ranks = {0};
    list.offsets = {0, last - first};
    list.rows = Kokkos::subview(found.nodes_to_send.rows, std::make_pair(first, last));
    exchangeNodeBoxes(space, MPI_COMM_SELF, surface, config.node_tolerance, list, {0}, messages);
  }
};

// Means over the ranks that are built.
struct LocalCosts {
  double faces = 0, nodes_sent = 0, blocks_tested = 0, faces_sent = 0, partners = 0;
  double boxes_seconds = 0, candidates_seconds = 0, node_boxes_seconds = 0; // phases 1, 3, 4
};

class Replayed {
public:
  Replayed(const Scene& scene, int ranks)
      : _scene(scene), _cells(bisectedCells(scene.domain, ranks)) {
    if (scene.is_numbered_at_random)
      std::shuffle(_cells.begin(), _cells.end(), std::mt19937_64(1));
    double longest = 0;
    for (int d = 0; d < 3; ++d)
      longest = std::max(longest, _cells[0].upper[d] - _cells[0].lower[d]);
    _records = recordsOf(_cells, 0.5 * scene.edge() + scene.tolerance() + box_margin * longest);
    if (scene.has_stray)
      _records[std::size_t(ranks / 3)].face_box = scene.domain;
    const double begin = MPI_Wtime();
    _replay = replayExchange(_records);
    _tree_seconds = (MPI_Wtime() - begin) / ranks;
    std::vector<int> built = {ranks / 2, 2 * ranks / 3};
    if (ranks <= 16) {
      built.resize(std::size_t(ranks));
      std::iota(built.begin(), built.end(), 0);
    } else if (facesInAll() / ranks < 30000) { // larger surfaces take long to build
      built.insert(built.end(), {0, ranks / 4, 5 * ranks / 7});
    }
    for (const int q : built)
      addRank(q, 1.0 / static_cast<double>(built.size()));
    countFaces(ranks);
  }

  void print() const {
    const auto of = [&](auto count) { return overRanks(_replay, count); };
    const int ranks = static_cast<int>(_cells.size());
    std::printf("\"%s\",%d,%d,%.0f,%.2f,%.0f,%.1f,%.0f,%.1f,%.0f,%.3f,", _scene.name.c_str(),
                _scene.n, ranks, of(&ExchangeCounts::messages).max,
                of(&ExchangeCounts::partners).mean, of(&ExchangeCounts::partners).max,
                of(&ExchangeCounts::bytes).mean, of(&ExchangeCounts::bytes).max,
                of(&ExchangeCounts::box_tests).mean, of(&ExchangeCounts::box_tests).max,
                1e6 * _tree_seconds);
    std::printf("%.1f,%.2f,%.0f,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f\n", _mean_faces,
                _mean_faces > 0 ? _most_faces / _mean_faces : 1, _local.faces, _local.partners,
                _local.nodes_sent, _local.blocks_tested, _local.faces_sent,
                1e6 * _local.boxes_seconds, 1e6 * _local.candidates_seconds,
                1e6 * _local.node_boxes_seconds);
    std::fflush(stdout);
  }
  static void printHeader() {
    std::printf("scene,n,ranks,tree_messages,partners,partners_max,tree_bytes,tree_bytes_max,"
                "box_tests,box_tests_max,tree_us,faces,faces_max_over_mean,built_faces,"
                "built_partners,node_boxes_sent,blocks_tested,faces_sent,boxes_us,candidates_us,"
                "node_boxes_us\n");
  }

private:
  double facesInAll() const {
    double volume = 1;
    for (int d = 0; d < 3; ++d)
      volume *= _scene.domain.upper[d];
    return volume / volume_of_brick * 10 * _scene.n * _scene.n;
  }

  BuiltRank build(int q) const {
    const auto i = std::size_t(q);
    return {_space, _scene, _cells[i], _records[i], _replay.partners[i]};
  }

  void addRank(int q, double share) {
    BuiltRank rank = build(q);
    auto& found = rank.found;
    const auto add = [&](double& to, double value) { to += share * value; };
    add(_local.boxes_seconds,
        medianSeconds([&] { rank.clusters.update(_space, rank.surface, rank.config); }));
    add(_local.candidates_seconds, medianSeconds([&] {
          findPartnersAndCandidates(_space, rank.clusters, rank.boxes, found);
        }));
    add(_local.faces, rank.surface.num_faces);
    add(_local.partners, static_cast<double>(_replay.partners[std::size_t(q)].size()));
    add(_local.nodes_sent, static_cast<double>(found.nodes_to_send.size()));
    add(_local.blocks_tested, static_cast<double>(found.blocks_to_test.size()));
    PartnerMessages messages;
    add(_local.node_boxes_seconds, medianSeconds([&] {
          rank.sendNodeBoxes(_space, 0, found.nodes_to_send.size(), messages);
        }));
    add(_local.faces_sent, static_cast<double>(facesSent(q, rank)));
  }

  // Phases 4 and 5: the faces that rank q would send, with the node boxes of each partner that is
  // not stray. Phase 6 sends them.
  std::int64_t facesSent(int q, const BuiltRank& rank) const {
    std::int64_t sent = 0;
    const PartnerLists& tested = rank.found.blocks_to_test;
    for (std::size_t p = 0; p < tested.ranks.size(); ++p) {
      const BuiltRank other = build(tested.ranks[p]);
      const PartnerLists& nodes = other.found.nodes_to_send;
      const auto it = std::find(nodes.ranks.begin(), nodes.ranks.end(), q);
      const auto o = std::size_t(it - nodes.ranks.begin());
      PartnerMessages messages;
      other.sendNodeBoxes(_space, nodes.offsets[o], nodes.offsets[o + 1], messages);
      PartnerLists blocks;
      blocks.ranks = {0};
      blocks.offsets = {0, tested.offsets[p + 1] - tested.offsets[p]};
      blocks.rows =
          Kokkos::subview(tested.rows, std::make_pair(tested.offsets[p], tested.offsets[p + 1]));
      BlockGhostSearch search;
      searchLocalFacesAgainstRemoteNodes(_space, rank.surface, rank.clusters,
                                         rank.config.face_tolerance, blocks, messages, search);
      sent += search.faces_to_send.size();
    }
    return sent;
  }

  // On some ranks, drawn at random. The largest of these is a lower bound of that of all.
  void countFaces(int ranks) {
    if (facesInAll() / ranks >= 30000) {
      _mean_faces = _most_faces = facesInAll() / ranks;
      return;
    }
    std::mt19937_64 engine(1);
    for (int i = 0; i < num_counted; ++i) {
      const auto q = static_cast<std::size_t>(engine() % static_cast<std::uint64_t>(ranks));
      const double faces = CellSurface(_cells[q], _scene).numFaces();
      _mean_faces += faces / num_counted;
      _most_faces = std::max(_most_faces, faces);
    }
  }

  exec_space _space;
  Scene _scene;
  std::vector<Box> _cells;
  std::vector<RankRecord> _records;
  Replay _replay;
  double _tree_seconds = 0;
  LocalCosts _local;
  double _mean_faces = 0, _most_faces = 0;
};

void measure(const Scene& scene, int ranks) {
  Replayed(scene, ranks).print();
}

void measureWeak(int ranks) {
  // Costs that grow with all ranks are not replayed beyond this number.
  constexpr int most_ranks_at_random = 4096;
  const double volume = ranks * bricks_per_rank * volume_of_brick;
  const Box wall = boxOf(std::sqrt(volume), 1, std::sqrt(volume));
  const double side = std::cbrt(volume);
  measure({"wall", 8, wall, false, false, 0, 0}, ranks);
  measure({"pile", 8, boxOf(side, side, side), false, false, 0, 0}, ranks);
  measure({"wall, one stray box", 8, wall, false, true, 0, 0}, ranks);
  if (ranks <= most_ranks_at_random)
    measure({"wall, ranks at random", 8, wall, true, false, 0, 0}, ranks);
}

void run(const std::vector<std::string>& words) {
  const bool is_wall = words.size() > 3 && words[0] == "wall";
  if (!is_wall && (words.size() < 2 || words[0] != "weak"))
    throw InputError("usage: contact_virtual_ranks weak RANKS... | wall N FACTOR RANKS...");
  const auto number = [&](std::size_t i) { return std::max(1, std::atoi(words[i].c_str())); };
  Replayed::printHeader();
  for (std::size_t i = is_wall ? 3 : 1; i < words.size(); ++i) {
    if (!is_wall) {
      measureWeak(number(i));
      continue;
    }
    const int factor = number(2); // the deck's wall is 15 bricks along and 29 up, with ragged ends
    measure({"W(" + words[1] + ")" + (factor > 1 ? " x" + std::to_string(factor * factor) : ""),
             number(1), boxOf(30.0 * factor + 1, 1, 29.0 * factor), false, false, 15 * factor,
             29 * factor},
            number(i));
  }
}

} // namespace
} // namespace brickwall::contact

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  return brickwall::benchmarkMain(argc, argv, [&] { brickwall::contact::run(words); });
}
