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

// The device keeps them as long as rank boxes hold.
View<FloatBounds*> reachOf(const exec_space& space, const NearRanks& partners, const Vec3& origin,
                           ClusterCandidates::Scratch& scratch) {
  std::vector<FloatBounds> reach;
  for (const Box& box : partners.boxes)
    reach.push_back(FloatBounds::of(box, origin).reach());
  if (reach != scratch.host_reach) {
    const Region copies("contact::search::host_device_copies");
    copyToDevice(space, reach, scratch.reach);
    scratch.host_reach = reach;
  }
  return scratch.reach;
}

std::int64_t numPartners(const PartnerLists& lists) {
  return static_cast<std::int64_t>(lists.ranks.size());
}

// Counts the results of `emit` for each partner, chunk by chunk; starts(first + partner) will be
// the offset of those of a partner.
template <class Emit>
void count(const exec_space& space, const std::string& label, const Emit& emit,
           const PartnerLists& lists, std::int64_t first, const View<std::int64_t*>& starts,
           ClusterCandidates::Scratch& scratch) {
  const std::int64_t n = numPartners(lists), num_chunks = emit.num_chunks;
  countAndScan<int>(space, label, n * num_chunks, emit, scratch.offsets);
  const auto offsets = scratch.offsets;
  Kokkos::parallel_for(
      label + "::starts", rangePolicy(space, n + 1),
      KOKKOS_LAMBDA(const std::int64_t p) { starts(first + p) = offsets(p * num_chunks); });
}
template <class Emit>
void fill(const exec_space& space, const std::string& label, const Emit& emit,
          const std::int64_t* starts, const ClusterCandidates::Scratch& scratch,
          PartnerLists& lists) {
  const std::int64_t n = numPartners(lists);
  lists.offsets.assign(starts, starts + n + 1);
  fillEmitted(space, label, n * emit.num_chunks, emit, scratch.offsets, starts[n], lists.rows);
}

// Lists both; the host waits once, for all counts.
void findCandidates(const exec_space& space, const SurfaceClusters& clusters,
                    const RankBoxes& rank_boxes, ClusterCandidates& candidates) {
  auto& nodes = candidates.nodes_to_send;
  auto& blocks = candidates.blocks_to_test;
  nodes.offsets.assign(nodes.ranks.size() + 1, 0);
  blocks.offsets.assign(blocks.ranks.size() + 1, 0);
  const ClusterOrder& order = clusters.order();
  const BoxTree& faces = clusters.faceTree();
  const bool has_nodes = !nodes.ranks.empty();
  const bool has_blocks = !blocks.ranks.empty() && faces.num_levels > 0;
  if (!has_nodes && !has_blocks)
    return;
  const int level = minOf(faces.num_levels - 1, max_chunk_levels);
  const NodesNearPartner emit_nodes{
      reachOf(space, rank_boxes.near_nodes, order.origin, candidates.of_nodes),
      clusters.clusterBounds(),
      clusters.nodeBounds(),
      order.owned,
      order.node_order,
      order.num_clusters,
      (order.num_clusters + clusters_per_chunk - 1) / clusters_per_chunk};
  const BlocksNearPartner emit_blocks{
      reachOf(space, rank_boxes.near_faces, order.origin, candidates.of_blocks), faces, level,
      has_blocks ? faces.numBlocks(level) : 0};
  const char* const name_of_nodes = "contact::ClusterCandidates::nodes";
  const char* const name_of_blocks = "contact::ClusterCandidates::faces";
  const std::int64_t first_block = numPartners(nodes) + 1;
  const std::int64_t num_starts = first_block + numPartners(blocks) + 1;
  growTo(space, candidates.starts, num_starts);
  if (has_nodes)
    count(space, name_of_nodes, emit_nodes, nodes, 0, candidates.starts, candidates.of_nodes);
  if (has_blocks)
    count(space, name_of_blocks, emit_blocks, blocks, first_block, candidates.starts,
          candidates.of_blocks);
  {
    const Region copies("contact::search::host_device_copies");
    copyToHost(space, candidates.starts, num_starts, candidates.host_starts);
  }
  const std::int64_t* const starts = candidates.host_starts.data();
  if (has_nodes)
    fill(space, name_of_nodes, emit_nodes, starts, candidates.of_nodes, nodes);
  if (has_blocks)
    fill(space, name_of_blocks, emit_blocks, starts + first_block, candidates.of_blocks, blocks);
}

} // namespace

void findPartnersAndCandidates(const exec_space& space, const SurfaceClusters& clusters,
                               const RankBoxes& rank_boxes, ClusterCandidates& candidates) {
  const Region region("contact::findPartnersAndCandidates");
  candidates.nodes_to_send.ranks = rank_boxes.near_nodes.ranks;
  candidates.blocks_to_test.ranks = rank_boxes.near_faces.ranks;
  const Region timer("contact::search::searches_0_and_1");
  findCandidates(space, clusters, rank_boxes, candidates);
}

} // namespace brickwall::contact
