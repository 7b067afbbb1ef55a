#include "contact/search/cluster/cluster_candidates.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "contact/base/scan.hpp"
#include "contact/search/cluster/lane_masks.hpp"
#include "contact/search/spatial/tree_walk.hpp"

namespace brickwall::contact {
namespace {

// Nodes and blocks are tested in groups, each of which has a mask; on a device a thread tests one
// of a group, so that threads side by side read boxes side by side.
constexpr int items_per_group = GroupsNearPartners::nodes_of_group;
static_assert(items_per_group == 32, "a bit for each");
constexpr int testing_threads = fills_lanes ? 1 : items_per_group; // of a group
constexpr int listing_threads = fills_lanes ? 1 : 4;

constexpr int numGroups(std::int64_t items) {
  return static_cast<int>(dividedUp<std::int64_t>(items, items_per_group));
}

// The owned nodes, by position.
struct Nodes {
  View<const float*> cluster_bounds, node_bounds;
  View<const unsigned*> owned;
  View<const int*> node_order;
  int num_clusters;

  KOKKOS_INLINE_FUNCTION bool mayBeNear(int group, const FloatBounds& limit) const {
    constexpr int clusters = items_per_group / cluster_size;
    const int end = minOf((group + 1) * clusters, num_clusters);
    for (int cluster = group * clusters; cluster < end; ++cluster)
      if (isWithin(&cluster_bounds(std::int64_t(6) * cluster), limit))
        return true;
    return false;
  }
  KOKKOS_INLINE_FUNCTION bool isNear(std::int64_t position, const FloatBounds& limit) const {
    const std::int64_t cluster = position / cluster_size;
    return cluster < num_clusters && isWithin(&node_bounds(6 * position), limit) &&
           (owned(cluster) >> static_cast<int>(position % cluster_size) & 1u) != 0;
  }
  KOKKOS_INLINE_FUNCTION int row(std::int64_t position) const { return node_order(position); }
};

// The blocks of eight faces.
struct Blocks {
  BoxTree faces;

  KOKKOS_INLINE_FUNCTION bool mayBeNear(int group, const FloatBounds& limit) const {
    constexpr int lanes = items_per_group / block_size; // of a block of level 2
    if (faces.num_levels <= 2)
      return true;
    const int first = group * lanes;
    return (lanesOverlapping(faces.block(2, first / block_size), limit) >> first % block_size &
            ((1u << lanes) - 1)) != 0;
  }
  KOKKOS_INLINE_FUNCTION bool isNear(std::int64_t block, const FloatBounds& limit) const {
    if (block >= faces.numBlocks(0))
      return false;
    const FloatBounds box =
        faces.num_levels > 1 // the union of a single block is not stored
            ? boundsOfLane(faces.block(1, block / block_size), static_cast<int>(block % block_size))
            : unionOfBlock(faces.block(0, 0));
    return isWithin(box.side, limit);
  }
  KOKKOS_INLINE_FUNCTION static int row(std::int64_t block) { return static_cast<int>(block); }
};

// The groups of all partners.
struct Groups {
  View<const FloatBounds*> reach;
  Nodes nodes;
  Blocks blocks;
  int node_groups, block_groups; // of a partner
  std::int64_t node_partners, block_partners;

  KOKKOS_INLINE_FUNCTION std::int64_t firstOf(std::int64_t partner) const {
    return minOf(partner, node_partners) * node_groups +
           maxOf(partner - node_partners, std::int64_t(0)) * block_groups;
  }
  std::int64_t count() const { return firstOf(node_partners + block_partners); }

  // Calls visit(nodes or blocks, reach of the partner, group).
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void at(int i, const Visit& visit) const {
    const auto first_block = static_cast<int>(firstOf(node_partners));
    if (i < first_block)
      visit(nodes, reach(i / node_groups), i % node_groups);
    else
      visit(blocks, reach(node_partners + (i - first_block) / block_groups),
            (i - first_block) % block_groups);
  }
};

// The device keeps them as long as rank boxes hold.
void updateReach(const exec_space& space, const RankBoxes& rank_boxes, const Vec3& origin,
                 ClusterCandidates& candidates) {
  std::vector<FloatBounds> reach;
  for (const NearRanks* partners : {&rank_boxes.near_nodes, &rank_boxes.near_faces})
    for (const Box& box : partners->boxes)
      reach.push_back(FloatBounds::of(box, origin).reach());
  if (reach != candidates.host_reach) {
    const Region copies("contact::search::host_device_copies");
    copyToDevice(space, reach, candidates.reach);
    candidates.host_reach = reach;
  }
}

// Sets the masks.
void testGroups(const exec_space& space, const Groups& groups, ClusterCandidates& candidates) {
  const std::int64_t n = groups.count();
  growTo(space, candidates.masks, n);
  const auto masks = candidates.masks;
  clearMasks<testing_threads>(space, masks);
  Kokkos::parallel_for(
      "contact::ClusterCandidates::test", rangePolicy(space, n * testing_threads),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const auto of_all = static_cast<int>(i / testing_threads);
        const auto first = static_cast<int>(i % testing_threads);
        groups.at(of_all, [&](const auto& items, const FloatBounds& limit, int group) {
          unsigned mask = 0;
          if (testing_threads > 1 || items.mayBeNear(group, limit))
            for (int k = first; k < items_per_group; k += testing_threads)
              mask |= static_cast<unsigned>(
                          items.isNear(std::int64_t(group) * items_per_group + k, limit))
                      << k;
          storeMask<testing_threads>(masks(of_all), mask);
        });
      });
}

// Sets the offsets of both lists from the masks; the host waits.
void countRows(const exec_space& space, const Groups& groups, ClusterCandidates& candidates) {
  const std::int64_t n = groups.count();
  const std::int64_t num_partners = groups.node_partners + groups.block_partners;
  growTo(space, candidates.offsets, n + 1);
  growTo(space, candidates.starts, num_partners + 1);
  const auto offsets = candidates.offsets, starts = candidates.starts;
  launchScan(space, "contact::ClusterCandidates::scan", CountMasked{candidates.masks}, n, offsets);
  Kokkos::parallel_for(
      "contact::ClusterCandidates::starts", rangePolicy(space, num_partners + 1),
      KOKKOS_LAMBDA(const std::int64_t p) { starts(p) = offsets(groups.firstOf(p)); });
  const Region copies("contact::search::host_device_copies");
  copyToHost(space, starts, num_partners + 1, candidates.host_starts);
  const auto first_block = candidates.host_starts.begin() + groups.node_partners;
  candidates.nodes_to_send.offsets.assign(candidates.host_starts.begin(), first_block + 1);
  auto& of_blocks = candidates.blocks_to_test.offsets;
  of_blocks.assign(first_block, candidates.host_starts.end());
  for (std::int64_t& offset : of_blocks)
    offset -= *first_block;
}

void listRows(const exec_space& space, const Groups& groups, ClusterCandidates& candidates) {
  auto& nodes = candidates.nodes_to_send;
  auto& blocks = candidates.blocks_to_test;
  growTo(space, nodes.rows, nodes.size());
  growTo(space, blocks.rows, blocks.size());
  const View<const unsigned*> masks = candidates.masks;
  const View<const std::int64_t*> offsets = candidates.offsets;
  const auto node_rows = nodes.rows, block_rows = blocks.rows;
  const std::int64_t num_nodes = nodes.size();
  Kokkos::parallel_for(
      "contact::ClusterCandidates::list", rangePolicy(space, groups.count() * listing_threads),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const auto of_all = static_cast<int>(i / listing_threads);
        const auto first = static_cast<int>(i % listing_threads);
        const unsigned mask = masks(of_all);
        if ((mask >> first) == 0)
          return;
        groups.at(of_all, [&](const auto& items, const FloatBounds&, int group) {
          for (int k = first; k < items_per_group; k += listing_threads)
            if ((mask >> k & 1u) != 0) {
              const std::int64_t to = offsets(of_all) + countBits(mask & ((1u << k) - 1));
              const int row = items.row(std::int64_t(group) * items_per_group + k);
              (to < num_nodes ? node_rows(to) : block_rows(to - num_nodes)) = row;
            }
        });
      });
}

} // namespace

void findPartnersAndCandidates(const exec_space& space, const SurfaceClusters& clusters,
                               const RankBoxes& rank_boxes, ClusterCandidates& candidates,
                               const std::function<void()>& have_tested) {
  const Region region("contact::findPartnersAndCandidates");
  auto& nodes = candidates.nodes_to_send;
  auto& blocks = candidates.blocks_to_test;
  nodes.ranks = rank_boxes.near_nodes.ranks;
  blocks.ranks = rank_boxes.near_faces.ranks;
  nodes.offsets.assign(nodes.ranks.size() + 1, 0);
  blocks.offsets.assign(blocks.ranks.size() + 1, 0);
  const Region timer("contact::search::searches_0_and_1");
  const ClusterOrder& order = clusters.order();
  const BoxTree& faces = clusters.faceTree();
  const std::int64_t num_nodes = std::int64_t(order.num_clusters) * cluster_size;
  Groups groups{candidates.reach,
                {clusters.clusterBounds(), clusters.nodeBounds(), order.owned, order.node_order,
                 order.num_clusters},
                {faces},
                numGroups(num_nodes),
                numGroups(faces.num_levels > 0 ? faces.numBlocks(0) : 0),
                static_cast<std::int64_t>(nodes.ranks.size()),
                static_cast<std::int64_t>(blocks.ranks.size())};
  if (checkedInt(groups.count(), "groups of candidates") == 0)
    return;
  updateReach(space, rank_boxes, order.origin, candidates);
  groups.reach = candidates.reach;
  testGroups(space, groups, candidates);
  if (have_tested)
    have_tested();
  countRows(space, groups, candidates);
  listRows(space, groups, candidates);
}

GroupsNearPartners nodesNearPartners(const ClusterCandidates& candidates) {
  return {candidates.masks, static_cast<int>(candidates.nodes_to_send.ranks.size())};
}

} // namespace brickwall::contact
