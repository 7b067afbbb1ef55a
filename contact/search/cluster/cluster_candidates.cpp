#include "contact/search/cluster/cluster_candidates.hpp"

#include "contact/base/count_scan_fill.hpp"
#include "contact/base/region.hpp"
#include "contact/search/spatial/tree_walk.hpp"

namespace brickwall::contact {
namespace {

// The work of one thread for one partner.
constexpr int clusters_per_chunk = cluster_size > 1 ? 64 : 16;
constexpr int max_chunk_levels = 2; // a block of this level of the face tree, or of its top

// Emits the owned nodes of chunk i % num_chunks that may meet the rank box of partner i /
// num_chunks.
struct NodesNearPartner {
  View<const FloatBounds*> reach;
  View<const float*> cluster_bounds, node_bounds;
  View<const unsigned*> owned;
  View<const int*> node_order;
  int num_clusters;
  std::int64_t num_chunks;

  template <class Sink>
  KOKKOS_INLINE_FUNCTION void operator()(std::int64_t i, const Sink& sink) const {
    const FloatBounds& limit = reach(i / num_chunks);
    const auto first = static_cast<int>(i % num_chunks * clusters_per_chunk);
    const int end = minOf(first + clusters_per_chunk, num_clusters);
    for (int cluster = first; cluster < end; ++cluster) {
      if (!isWithin(&cluster_bounds(std::int64_t(6) * cluster), limit))
        continue;
      for (int lane = 0; lane < cluster_size; ++lane) {
        const std::int64_t position = std::int64_t(cluster) * cluster_size + lane;
        if ((owned(cluster) >> lane & 1u) != 0 && isWithin(&node_bounds(6 * position), limit))
          sink(node_order(position));
      }
    }
  }
};

// Emits the blocks of eight faces, below block i % num_chunks of level `level`, that may meet the
// rank box of partner i / num_chunks.
struct BlocksNearPartner {
  View<const FloatBounds*> reach;
  BoxTree faces;
  int level;
  std::int64_t num_chunks;

  template <class Sink>
  KOKKOS_INLINE_FUNCTION void operator()(std::int64_t i, const Sink& sink) const {
    const FloatBounds& limit = reach(i / num_chunks);
    if (level == 0) { // a single block, whose union is not stored
      const FloatBounds all = unionOfBlock(faces.block(0, 0));
      if (isWithin(all.side, limit))
        sink(0);
      return;
    }
    walkLevels(faces, level, i % num_chunks, 1, limit, [&](std::int64_t block) {
      sink(static_cast<int>(block));
      return true;
    });
  }
};

void setReach(const exec_space& space, const NearRanks& partners, const Vec3& origin,
              ClusterCandidates& candidates) {
  candidates.host_reach.clear();
  for (const Box& box : partners.boxes)
    candidates.host_reach.push_back(FloatBounds::of(box, origin).reach());
  const Region copies("contact::search::host_device_copies");
  copyToDevice(space, candidates.host_reach, candidates.reach);
}

// Lists the results of `emit` for each partner, chunk by chunk.
template <class Emit>
void listByPartner(const exec_space& space, const std::string& label, const Emit& emit,
                   ClusterCandidates& candidates, PartnerLists& lists) {
  const auto num_partners = static_cast<std::int64_t>(lists.ranks.size());
  const std::int64_t num_chunks = emit.num_chunks;
  countScanFill(space, label, num_partners * num_chunks, emit, candidates.offsets, lists.rows);
  growTo(space, candidates.starts, num_partners + 1);
  const auto offsets = candidates.offsets, starts = candidates.starts;
  Kokkos::parallel_for(
      label + "::starts", rangePolicy(space, num_partners + 1),
      KOKKOS_LAMBDA(const std::int64_t p) { starts(p) = offsets(p * num_chunks); });
  const Region copies("contact::search::host_device_copies");
  copyToHost(space, candidates.starts, num_partners + 1, lists.offsets);
}

void findNodesToSend(const exec_space& space, const SurfaceClusters& clusters,
                     const RankBoxes& rank_boxes, ClusterCandidates& candidates) {
  auto& lists = candidates.nodes_to_send;
  lists.offsets.assign(lists.ranks.size() + 1, 0);
  if (lists.ranks.empty())
    return;
  const ClusterOrder& order = clusters.order();
  setReach(space, rank_boxes.near_nodes, order.origin, candidates);
  const NodesNearPartner emit{candidates.reach,
                              clusters.clusterBounds(),
                              clusters.nodeBounds(),
                              order.owned,
                              order.node_order,
                              order.num_clusters,
                              (order.num_clusters + clusters_per_chunk - 1) / clusters_per_chunk};
  listByPartner(space, "contact::ClusterCandidates::nodes", emit, candidates, lists);
}

void findBlocksToTest(const exec_space& space, const SurfaceClusters& clusters,
                      const RankBoxes& rank_boxes, ClusterCandidates& candidates) {
  auto& lists = candidates.blocks_to_test;
  lists.offsets.assign(lists.ranks.size() + 1, 0);
  const BoxTree& faces = clusters.faceTree();
  if (lists.ranks.empty() || faces.num_levels == 0)
    return;
  setReach(space, rank_boxes.near_faces, clusters.order().origin, candidates);
  const int level = minOf(faces.num_levels - 1, max_chunk_levels);
  const BlocksNearPartner emit{candidates.reach, faces, level, faces.numBlocks(level)};
  listByPartner(space, "contact::ClusterCandidates::faces", emit, candidates, lists);
}

} // namespace

void findPartnersAndCandidates(const exec_space& space, const SurfaceClusters& clusters,
                               const RankBoxes& rank_boxes, ClusterCandidates& candidates) {
  const Region region("contact::findPartnersAndCandidates");
  candidates.nodes_to_send.ranks = rank_boxes.near_nodes.ranks;
  candidates.blocks_to_test.ranks = rank_boxes.near_faces.ranks;
  const Region timer("contact::search::searches_0_and_1");
  findNodesToSend(space, clusters, rank_boxes, candidates);
  findBlocksToTest(space, clusters, rank_boxes, candidates);
}

} // namespace brickwall::contact
