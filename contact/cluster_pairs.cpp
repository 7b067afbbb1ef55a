#include "contact/cluster_pairs.hpp"

#include "contact/base/count_scan_fill.hpp"
#include "contact/base/error.hpp"
#include "contact/candidate_rules.hpp"
#include "contact/cluster_walk.hpp"
#include "contact/construct_boxes.hpp"
#include "contact/row_order.hpp"

namespace brickwall::contact {
namespace {

using DeviceRules = PairRules<memory_space>;

constexpr int row_width = cluster_size + 1; // entries of CandidatePairs::row_begin for a cluster
constexpr int to_be_repeated = -1; // in the first of them, which else is 0
constexpr int most_hits = cluster_size > 1 ? 256 : 32; // kept by a walk; more take another walk

// Faces that some nodes of a cluster may touch.
struct Hits {
  int face[most_hits];
  unsigned lanes[most_hits];
  int count = 0; // may exceed most_hits
  bool by_index = true; // the order of (body, face id) is that of the indices
  int length[cluster_size] = {}; // of each node's row

  KOKKOS_INLINE_FUNCTION void add(int candidate, unsigned of_lanes) {
    if (count < most_hits) {
      face[count] = candidate;
      lanes[count] = of_lanes;
    }
    ++count;
    for (int lane = 0; lane < cluster_size; ++lane)
      length[lane] += static_cast<int>(of_lanes >> lane & 1u);
  }
};

// Everything that a search reads, and the decision about one pair.
struct PairTest {
  Surface surface;
  GhostFaces ghosts;
  ClusterOrder order;
  DeviceRules rules;
  double node_tolerance, face_tolerance;
  bool drop_same_body;

  // Whether the boxes overlap, in double: for pairs that floats cannot tell.
  KOKKOS_INLINE_FUNCTION bool overlap(int node, int face) const {
    const Box of_node = nodeBox(rowOf(surface.coordinates_old, node),
                                rowOf(surface.coordinates_new, node), node_tolerance);
    Box of_face;
    for (int corner = 0; corner < 4; ++corner)
      if (face < surface.num_faces) {
        const int other = surface.face_to_nodes(face, corner);
        of_face.include(rowOf(surface.coordinates_old, other));
        of_face.include(rowOf(surface.coordinates_new, other));
      } else {
        of_face.include(ghostCorner(ghosts.coordinates_old, face - surface.num_faces, corner));
        of_face.include(ghostCorner(ghosts.coordinates_new, face - surface.num_faces, corner));
      }
    of_face.inflate(face_tolerance);
    return of_node.overlaps(of_face);
  }
  KOKKOS_INLINE_FUNCTION static Vec3 ghostCorner(const GhostFaces::CornerCoordinates& x, int ghost,
                                                 int corner) {
    return {x(ghost, 3 * corner), x(ghost, 3 * corner + 1), x(ghost, 3 * corner + 2)};
  }
  // By (body, face id).
  KOKKOS_INLINE_FUNCTION bool before(int a, int b) const {
    if (a < surface.num_faces && b < surface.num_faces)
      return order.face_rank.extent(0) > 0 ? order.face_rank(a) < order.face_rank(b) : a < b;
    return rules.before(a, b);
  }
};

// The search of one cluster.
struct FindRows {
  PairTest test;
  View<const float*> node_bounds;
  BoxTree face_tree, ghost_tree;
  View<const int*> room;
  View<const std::int64_t*> block_begin;
  View<int*> row_begin, faces;
  bool repeat; // only clusters whose place has changed

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t cluster, PairCounts& sums) const {
    int* const begin = &row_begin(cluster * row_width);
    if (repeat && begin[0] != to_be_repeated)
      return;
    const unsigned owned = test.order.owned(cluster);
    Hits hits;
    if (owned != 0) {
      NodeCluster nodes;
      nodes.load(&node_bounds(cluster * cluster_size * 6), owned);
      hits.by_index = test.order.face_rank.extent(0) == 0;
      const auto keep = [&](int face, unsigned lanes) {
        hits.add(face, lanes);
        hits.by_index &= face < test.surface.num_faces;
      };
      walkFaces(nodes, static_cast<int>(cluster), sums, keep);
      walkGhosts(nodes, static_cast<int>(cluster), sums, keep);
    }
    std::int64_t length = 0;
    for (int lane = 0; lane < cluster_size; ++lane) {
      begin[lane] = static_cast<int>(length);
      length += hits.length[lane];
    }
    begin[cluster_size] = static_cast<int>(length);
    sums.pairs += length;
    if (length > room(cluster))
      ++sums.crowded;
    else if (length > 0)
      writeRows(hits, begin, &faces(block_begin(cluster)), static_cast<int>(cluster), owned);
  }

  // keep(face, lanes) for the own faces that nodes of these lanes may touch.
  template <class Keep>
  KOKKOS_INLINE_FUNCTION void walkFaces(const NodeCluster& nodes, int cluster, PairCounts& sums,
                                        const Keep& keep) const {
    const int first = cluster * cluster_size;
    walkBlocks(face_tree, nodes.all, [&](const std::int64_t block) {
      const float* const boxes = face_tree.block(0, block);
      unsigned lanes = lanesOverlapping(boxes, nodes.all);
      ++sums.blocks;
      if (lanes == 0)
        return;
      unsigned own[block_size]; // nodes of the cluster that are corners of the faces
      bitsOfNumbers(&test.order.corners(block * 4 * block_size), first, own);
      for (; lanes != 0; lanes &= lanes - 1) {
        const int lane = lowestBit(lanes);
        ++sums.faces;
        const float* const box = boxes + lane;
        const unsigned near =
            lanesReaching<cluster_size>(nodes.lanes, box, block_size) & ~own[lane];
        if (near == 0)
          continue;
        const int face = test.order.face_order(block * block_size + lane);
        const unsigned hit = decide(nodes, near, box, first, face);
        if (hit != 0)
          keep(face, hit);
      }
    });
  }

  template <class Keep>
  KOKKOS_INLINE_FUNCTION void walkGhosts(const NodeCluster& nodes, int cluster, PairCounts& sums,
                                         const Keep& keep) const {
    walkBlocks(ghost_tree, nodes.all, [&](const std::int64_t block) {
      const float* const boxes = ghost_tree.block(0, block);
      ++sums.blocks;
      for (unsigned lanes = lanesOverlapping(boxes, nodes.all); lanes != 0; lanes &= lanes - 1) {
        const int lane = lowestBit(lanes);
        ++sums.faces;
        const float* const box = boxes + lane;
        const unsigned near = lanesReaching<cluster_size>(nodes.lanes, box, block_size);
        const int face = test.surface.num_faces + static_cast<int>(block) * block_size + lane;
        const unsigned hit = decide(nodes, near, box, cluster * cluster_size, face);
        if (hit != 0)
          keep(face, hit);
      }
    });
  }

  // Of the lanes that reach the face's box in floats: those that really overlap and that the rules allow.
  KOKKOS_INLINE_FUNCTION unsigned decide(const NodeCluster& nodes, unsigned near, const float* box,
                                         int first, int face) const {
    if (test.drop_same_body || face >= test.surface.num_faces)
      for (unsigned lanes = near; lanes != 0; lanes &= lanes - 1) {
        const int lane = lowestBit(lanes);
        if (!test.rules.allow(test.order.node_order(first + lane), face))
          near &= ~(1u << lane);
      }
    if (near == 0)
      return 0;
    unsigned unsure = near & ~lanesReaching<cluster_size, true>(nodes.lanes, box, block_size);
    for (; unsure != 0; unsure &= unsure - 1) {
      const int lane = lowestBit(unsure);
      if (!test.overlap(test.order.node_order(first + lane), face))
        near &= ~(1u << lane);
    }
    return near;
  }

  KOKKOS_INLINE_FUNCTION void writeRows(const Hits& hits, const int* begin, int* rows, int cluster,
                                        unsigned owned) const {
    int next[cluster_size];
    for (int lane = 0; lane < cluster_size; ++lane)
      next[lane] = begin[lane];
    const auto write = [&](int face, unsigned lanes) {
      for (; lanes != 0; lanes &= lanes - 1)
        rows[next[lowestBit(lanes)]++] = face;
    };
    if (hits.count <= most_hits) {
      for (int i = 0; i < hits.count; ++i)
        write(hits.face[i], hits.lanes[i]);
    } else {
      PairCounts again;
      NodeCluster nodes;
      nodes.load(&node_bounds(std::int64_t(cluster) * cluster_size * 6), owned);
      walkFaces(nodes, cluster, again, write);
      walkGhosts(nodes, cluster, again, write);
    }
    if (hits.by_index)
      sortRows(begin, rows, [](const int a, const int b) { return a < b; });
    else
      sortRows(begin, rows, [&](const int a, const int b) { return test.before(a, b); });
  }
  template <class Before>
  KOKKOS_INLINE_FUNCTION static void sortRows(const int* begin, int* rows, const Before& before) {
    for (int lane = 0; lane < cluster_size; ++lane)
      sortRow(rows + begin[lane], begin[lane + 1] - begin[lane], before);
  }
};

} // namespace

void ClusterPairs::refitGhosts(const exec_space& space, const GhostFaces& ghosts,
                               const Vec3& origin, double tolerance) {
  _ghost_forest.shape(space, {ghosts.count});
  const BoxTree tree = _ghost_forest.tree(0);
  const auto x_old = ghosts.coordinates_old, x_new = ghosts.coordinates_new;
  const std::int64_t lanes = tree.num_levels > 0 ? std::int64_t(tree.numBlocks(0)) * block_size : 0;
  Kokkos::parallel_for(
      "contact::ClusterPairs::ghost_boxes", over(space, lanes),
      KOKKOS_LAMBDA(const std::int64_t i) {
        FloatBounds bounds;
        if (i < tree.num_items) {
          Box box;
          for (int corner = 0; corner < 4; ++corner) {
            box.include(PairTest::ghostCorner(x_old, static_cast<int>(i), corner));
            box.include(PairTest::ghostCorner(x_new, static_cast<int>(i), corner));
          }
          box.inflate(tolerance);
          bounds = FloatBounds::of(box, origin);
        }
        storeLane(tree.block(0, i / block_size), static_cast<int>(i % block_size), bounds);
      });
  _ghost_forest.refitUpperLevels(space);
}

// Rows for a new order: no cluster has a place yet.
void ClusterPairs::startAnew(const exec_space& space, const SurfaceClusters& clusters,
                             CandidatePairs& pairs) {
  const ClusterOrder& order = clusters.order();
  const auto num_clusters = static_cast<std::size_t>(order.num_clusters);
  const auto exactly = [&](auto& view, std::size_t n) {
    if (view.extent(0) != n)
      view = std::decay_t<decltype(view)>(view.label(), n);
    else
      Kokkos::deep_copy(space, view, 0);
  };
  exactly(_room, num_clusters);
  exactly(_places, num_clusters + 1);
  exactly(pairs.block_begin, num_clusters);
  exactly(pairs.row_begin, num_clusters * row_width);
  pairs.row_nodes = order.node_order;
  _used = 0;
  _ordering = clusters.numOrderings();
}

// Gives crowded clusters a new place behind the used ones; if there is not room enough, all clusters get one. Returns
// whether it was all.
bool ClusterPairs::makeRoom(const exec_space& space, int num_clusters, CandidatePairs& pairs) {
  const auto places = _places;
  const auto room = _room;
  const auto row_begin = pairs.row_begin;
  const auto block_begin = pairs.block_begin;
  const auto needed = [&](bool all) {
    Kokkos::parallel_for(
        "contact::ClusterPairs::needed", over(space, num_clusters),
        KOKKOS_LAMBDA(const std::int64_t cluster) {
          const std::int64_t length = row_begin(cluster * row_width + cluster_size);
          places(cluster) = all || length > room(cluster) ? length + length / 8 + 2 : 0;
        });
    return scanCounts(space, "contact::ClusterPairs::places", places, num_clusters);
  };
  std::int64_t more = needed(false);
  const bool all = _used + more > static_cast<std::int64_t>(pairs.faces.extent(0));
  if (all) {
    _used = 0;
    more = needed(true);
    const auto size = static_cast<std::size_t>(more + more / 16 + 1024);
    if (pairs.faces.extent(0) < size) {
      pairs.faces = View<int*>(); // free first
      pairs.faces = allocate<View<int*>>(space, "contact::CandidatePairs::faces", size);
    }
  }
  const std::int64_t begin = _used;
  Kokkos::parallel_for(
      "contact::ClusterPairs::make_room", over(space, num_clusters),
      KOKKOS_LAMBDA(const std::int64_t cluster) {
        const std::int64_t size = places(cluster + 1) - places(cluster);
        if (size == 0)
          return;
        room(cluster) = static_cast<int>(size);
        block_begin(cluster) = begin + places(cluster);
        row_begin(cluster * row_width) = to_be_repeated;
      });
  _used += more;
  return all;
}

void ClusterPairs::find(const exec_space& space, const Surface& surface, const GhostFaces& ghosts,
                        const SurfaceClusters& clusters, const SearchConfig& config,
                        CandidatePairs& pairs) {
  const ClusterOrder& order = clusters.order();
  if (_ordering != clusters.numOrderings())
    startAnew(space, clusters, pairs);
  refitGhosts(space, ghosts, order.origin, config.face_tolerance);
  const PairTest test{surface,
                      ghosts,
                      order,
                      DeviceRules(surface, ghosts, config.drop_same_body),
                      config.node_tolerance,
                      config.face_tolerance,
                      config.drop_same_body};
  const auto search = [&](bool repeat) {
    PairCounts counts;
    Kokkos::parallel_reduce(
        "contact::ClusterPairs::find", overInChunks(space, order.num_clusters, 64),
        FindRows{test, clusters.nodeBounds(), clusters.faceTree(), _ghost_forest.tree(0), _room,
                 pairs.block_begin, pairs.row_begin, pairs.faces, repeat},
        Combine<PairCounts>(counts));
    space.fence();
    return counts;
  };
  _counts = search(false);
  if (_counts.crowded > 0) {
    makeRoom(space, order.num_clusters, pairs);
    const PairCounts repeated = search(true);
    _counts.blocks += repeated.blocks;
    _counts.faces += repeated.faces;
  }
  pairs.count = _counts.pairs;
  pairs.num_rows = surface.num_nodes;
}

} // namespace brickwall::contact
