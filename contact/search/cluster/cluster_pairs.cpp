#include "contact/search/cluster/cluster_pairs.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/scan.hpp"
#include "contact/search/cluster/group_rows.hpp"
#include "contact/surface/construct_boxes.hpp"

#include <utility>

namespace brickwall::contact {
namespace {

// Refits the tree of the ghosts, which are in the order of their arrival.
void refitGhosts(const exec_space& space, const GhostFaces& ghosts, const Vec3& origin,
                 double tolerance, BoxForest& forest) {
  forest.shape(space, ghosts.count);
  const BoxTree tree = forest.tree(0);
  const auto x_old = ghosts.coordinates_old, x_new = ghosts.coordinates_new;
  const std::int64_t lanes = tree.num_levels > 0 ? std::int64_t(tree.numBlocks(0)) * block_size : 0;
  Kokkos::parallel_for(
      "contact::ClusterPairs::ghost_boxes", rangePolicy(space, lanes),
      KOKKOS_LAMBDA(const std::int64_t i) {
        FloatBounds bounds;
        if (i < tree.num_items)
          bounds = FloatBounds::of(ghostBox(x_old, x_new, i, tolerance), origin);
        storeLane(tree.block(0, i / block_size), static_cast<int>(i % block_size), bounds);
      });
  forest.refitUpperLevels(space);
}

void setInitialCapacity(const exec_space& space, int num_clusters, const View<int*>& capacity,
                        const View<std::int64_t*>& block_begin) {
  Kokkos::parallel_for(
      "contact::ClusterPairs::initial_capacity", rangePolicy(space, num_clusters),
      KOKKOS_LAMBDA(const std::int64_t cluster) {
        capacity(cluster) = initial_capacity;
        block_begin(cluster) = cluster * initial_capacity;
      });
}

// Sets places [cluster + 1], the offsets of the capacity that overflowed clusters, or all, need.
// Returns the sum.
std::int64_t measureCapacity(const exec_space& space, int num_clusters, const View<int*>& row_begin,
                             const View<int*>& capacity, bool all,
                             const View<std::int64_t*>& places) {
  Kokkos::parallel_for(
      "contact::ClusterPairs::needed", rangePolicy(space, num_clusters),
      KOKKOS_LAMBDA(const std::int64_t cluster) {
        const std::int64_t length = row_begin(cluster * row_width + cluster_size);
        places(cluster) = all || length > capacity(cluster) ? length + length / 8 + 2 : 0;
      });
  return scanCounts(space, "contact::ClusterPairs::places", places, num_clusters);
}

void setCapacity(const exec_space& space, int num_clusters, const View<std::int64_t*>& places,
                 std::int64_t begin, const View<int*>& capacity, const CandidatePairs& pairs) {
  const auto row_begin = pairs.row_begin;
  const auto block_begin = pairs.block_begin;
  Kokkos::parallel_for(
      "contact::ClusterPairs::set_capacity", rangePolicy(space, num_clusters),
      KOKKOS_LAMBDA(const std::int64_t cluster) {
        const std::int64_t size = places(cluster + 1) - places(cluster);
        if (size == 0)
          return;
        capacity(cluster) = static_cast<int>(size);
        block_begin(cluster) = begin + places(cluster);
        row_begin(cluster * row_width) = needs_retry;
      });
}

PairCounts searchByClusters(const exec_space& space, const FindRows& find) {
  PairCounts counts;
  Kokkos::parallel_reduce("contact::ClusterPairs::find",
                          dynamicPolicy(space, dividedUp(find.num_clusters, group_size), 8), find,
                          PlusReducer<PairCounts>(counts));
  return counts;
}

constexpr bool by_groups = cluster_size == 1;

// A template, since FindRowsOfGroups is for clusters of one node.
template <class Find>
void launchGroups(const exec_space& space, const Find& find, const GroupsToSearch& groups,
                  LaunchedSums<PairCounts>& sums, GroupQueue& queue) {
  launchByGroups(space,
                 FindRowsOfGroups{find.test, find.node_bounds, find.face_tree, find.ghost_tree,
                                  find.capacity, find.block_begin, find.row_begin, find.faces,
                                  find.changed, find.num_clusters, queue, groups},
                 sums.next(space), queue);
}

// The search of a step, with rows of some clusters possibly too long for their capacity.
template <class Find>
PairCounts searchAll(const exec_space& space, Find find, const GroupsToSearch& groups,
                     const QueueMark& has_begun, const std::function<void()>& meanwhile,
                     LaunchedSums<PairCounts>& sums, GroupQueue& queue) {
  if constexpr (by_groups) {
    launchGroups(space, find, groups, sums, queue);
    if (meanwhile)
      meanwhile();
    if (groups.kind != GroupKind::all)
      has_begun.waitIn(space);
    PairCounts counts = sums.read(space);
    if (counts.skipped > 0) {
      find.repeat = true;
      counts += searchByClusters(space, find);
    }
    return counts;
  } else {
    return searchByClusters(space, find);
  }
}

} // namespace

// Lays out rows for a new order: every cluster has the same capacity.
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
  exactly(_capacity, num_clusters);
  exactly(_places, num_clusters + 1);
  if (cluster_size > 1) {
    exactly(_num_kept_hits, num_clusters);
    const std::size_t num_words = num_clusters * 2 * max_sorted_hits;
    if (_kept_hits.extent(0) != num_words)
      _kept_hits = allocate<View<unsigned*>>(space, "contact::ClusterPairs::kept_hits",
                                             static_cast<std::int64_t>(num_words));
  }
  exactly(pairs.block_begin, num_clusters);
  exactly(pairs.row_begin, num_clusters * row_width);
  exactly(pairs.changed, num_clusters);
  ++pairs.version;
  pairs.row_nodes = order.node_order;
  _used = std::int64_t(order.num_clusters) * initial_capacity;
  const std::int64_t size =
      _used + _used / 2 +
      1024; // with a reserve for clusters that need more; untouched memory costs nothing
  if (static_cast<std::int64_t>(pairs.faces.extent(0)) < size) {
    pairs.faces = View<int*>(); // free first
    pairs.faces = allocate<View<int*>>(space, "contact::CandidatePairs::faces", size);
  }
  setInitialCapacity(space, order.num_clusters, _capacity, pairs.block_begin);
  _ordering = clusters.numOrderings();
}

// Gives overflowed clusters a new part after the used ones; if the View is too small, all clusters
// get new parts.
void ClusterPairs::growCapacity(const exec_space& space, int num_clusters, CandidatePairs& pairs) {
  std::int64_t more =
      measureCapacity(space, num_clusters, pairs.row_begin, _capacity, false, _places);
  if (_used + more > static_cast<std::int64_t>(pairs.faces.extent(0))) {
    _used = 0;
    more = measureCapacity(space, num_clusters, pairs.row_begin, _capacity, true, _places);
    const auto size = static_cast<std::size_t>(more + more / 16 + 1024);
    if (pairs.faces.extent(0) < size) {
      const std::int64_t ordering = _ordering;
      _ordering = -1; // in case of a throw
      pairs.faces = View<int*>(); // free first
      pairs.faces = allocate<View<int*>>(space, "contact::CandidatePairs::faces", size);
      _ordering = ordering;
    }
  }
  setCapacity(space, num_clusters, _places, _used, _capacity, pairs);
  _used += more;
}

void ClusterPairs::startRows(const exec_space& space, const SurfaceClusters& clusters,
                             CandidatePairs& pairs) {
  if (_ordering != clusters.numOrderings())
    startAnew(space, clusters, pairs);
  ++pairs.version;
}

FindRows ClusterPairs::findRows(const SweptBoxes& surface, const GhostFaces& ghosts,
                                const BoxTree& ghost_tree, const SurfaceClusters& clusters,
                                const SearchConfig& config, const CandidatePairs& pairs) const {
  const ClusterOrder& order = clusters.order();
  return {{surface, ghosts, order, DeviceRules(surface, ghosts, config.drop_same_body),
           config.node_tolerance, config.face_tolerance, config.drop_same_body},
          clusters.nodeBounds(),
          clusters.clusterBounds(),
          clusters.faceTree(),
          ghost_tree,
          _capacity,
          pairs.block_begin,
          pairs.row_begin,
          pairs.faces,
          pairs.changed,
          {_num_kept_hits, _kept_hits},
          order.num_clusters,
          false};
}

void ClusterPairs::begin(const exec_space& space, const SweptBoxes& surface,
                         const SurfaceClusters& clusters, const SearchConfig& config,
                         const GroupsNearPartners& near_partners, CandidatePairs& pairs) {
  if constexpr (by_groups) {
    startRows(space, clusters, pairs);
    if (!_beside)
      _beside = queueBeside(space);
    _has_boxes.set(space);
    _has_boxes.waitIn(*_beside);
    launchGroups(*_beside,
                 findRows(surface, GhostFaces::none(), BoxTree(), clusters, config, pairs),
                 {GroupKind::far, near_partners}, _counts, _queue);
    _has_begun.set(*_beside);
    _groups = {GroupKind::near, near_partners};
  }
}

void ClusterPairs::forgetBegun() {
  if (_groups.kind == GroupKind::all)
    return;
  _counts.read(*_beside);
  _groups = {};
}

std::int64_t ClusterPairs::find(const exec_space& space, const SweptBoxes& surface,
                                const GhostFaces& ghosts, const SurfaceClusters& clusters,
                                const SearchConfig& config, const std::function<void()>& meanwhile,
                                CandidatePairs& pairs) {
  const ClusterOrder& order = clusters.order();
  checkedInt(std::int64_t(surface.num_faces) + ghosts.count, "own and ghost faces");
  if (_groups.kind == GroupKind::all)
    startRows(space, clusters, pairs);
  refitGhosts(space, ghosts, order.origin, config.face_tolerance, _ghost_forest);
  FindRows rows = findRows(surface, ghosts, _ghost_forest.tree(0), clusters, config, pairs);
  const PairCounts counts =
      searchAll(space, rows, std::exchange(_groups, {}), _has_begun, meanwhile, _counts, _queue);
  if (counts.overflowed > 0) {
    checkedInt(counts.largest + counts.largest / 8 + 2, "candidate pairs of a cluster of nodes");
    growCapacity(space, order.num_clusters, pairs);
    rows = findRows(surface, ghosts, _ghost_forest.tree(0), clusters, config, pairs);
    rows.repeat = true;
    searchByClusters(space, rows);
  }
  pairs.count = counts.pairs;
  pairs.num_rows = surface.num_nodes;
  return counts.blocks;
}

} // namespace brickwall::contact
