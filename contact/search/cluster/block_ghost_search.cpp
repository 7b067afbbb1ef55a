#include "contact/search/cluster/block_ghost_search.hpp"

#include "contact/base/region.hpp"
#include "contact/base/scan.hpp"
#include "contact/search/cluster/lane_masks.hpp"
#include "contact/search/exchange/node_box_exchange.hpp"
#include "contact/search/spatial/tree_walk.hpp"
#include "contact/surface/construct_boxes.hpp"

namespace brickwall::contact {
namespace {

// A thread of a device takes one face of a block: few blocks are near a partner.
constexpr int threads_per_block = fills_lanes ? 1 : block_size;

void buildNodeTrees(const exec_space& space, const PartnerMessages& node_boxes, const Vec3& origin,
                    BlockGhostSearch& search) {
  const auto& offsets = node_boxes.receiveOffsets();
  search.num_boxes.clear();
  for (std::size_t p = 0; p + 1 < offsets.size(); ++p)
    search.num_boxes.push_back(offsets[p + 1] - offsets[p]);
  search.node_trees.shape(space, search.num_boxes);
  const View<const std::int64_t*> words = node_boxes.buffers.receive;
  for (int p = 0; p < search.node_trees.numTrees(); ++p) {
    const BoxTree tree = search.node_trees.tree(p);
    const std::int64_t first = offsets[static_cast<std::size_t>(p)];
    const std::int64_t num_lanes = std::int64_t(tree.num_levels > 0 ? tree.numBlocks(0) : 0) * 8;
    Kokkos::parallel_for(
        "contact::BlockGhostSearch::leaves", rangePolicy(space, num_lanes),
        KOKKOS_LAMBDA(const std::int64_t i) {
          storeLane(tree.block(0, i / block_size), static_cast<int>(i % block_size),
                    i < tree.num_items ? FloatBounds::of(receivedNodeBox(words, first + i), origin)
                                       : FloatBounds());
        });
  }
  search.node_trees.refitUpperLevels(space);
}

// Those faces of a block, or the face of one lane, that overlap a node box of one sender.
struct BlockQuery {
  BoxTree faces;
  View<const int*> face_order;
  View<const double*[3]> x_old, x_new;
  View<const int* [4]> face_to_nodes;
  double face_tolerance;
  View<const std::int64_t*> words; // node boxes as received

  KOKKOS_INLINE_FUNCTION unsigned operator()(std::int64_t block, int first_lane,
                                             const BoxTree& nodes, std::int64_t first_node) const {
    const float* const lanes = faces.block(0, block);
    unsigned hit = 0, pending = 0;
    for (int lane = first_lane; lane < block_size; lane += threads_per_block)
      if (block * block_size + lane < faces.num_items)
        pending |= 1u << lane;
    const FloatBounds all =
        threads_per_block > 1 ? boundsOfLane(lanes, first_lane) : unionOfBlock(lanes);
    const auto visit = [&](std::int64_t node) {
      const FloatBounds reach =
          boundsOfLane(nodes.block(0, node / block_size), static_cast<int>(node % block_size))
              .reach();
      const unsigned may = lanesOverlapping(lanes, reach) & pending;
      if (may != 0) {
        unsigned met = lanesOverlapping<true>(lanes, reach) & may;
        for (unsigned unsure = may & ~met; unsure != 0; unsure &= unsure - 1)
          if (overlap(block * block_size + lowestBit(unsure), first_node + node))
            met |= unsure & (~unsure + 1u);
        hit |= met;
        pending &= ~met;
      }
      return pending != 0;
    };
    if (nodes.num_levels > 0)
      walkLevels(nodes, nodes.num_levels - 1, 0, 0, all.reach(), visit);
    return hit;
  }

  KOKKOS_INLINE_FUNCTION bool overlap(std::int64_t position, std::int64_t node) const {
    return faceBox(x_old, x_new, face_to_nodes, face_order(position), face_tolerance)
        .overlaps(receivedNodeBox(words, node));
  }
};

void findHits(const exec_space& space, const PartnerLists& blocks_to_test, const BlockQuery& query,
              const View<const std::int64_t*>& node_offsets, BlockGhostSearch& search) {
  const std::int64_t num_entries = blocks_to_test.size();
  growTo(space, search.hits, num_entries);
  const auto num_partners = static_cast<int>(blocks_to_test.ranks.size());
  const View<const int*> blocks = blocks_to_test.rows;
  const View<const std::int64_t*> starts = search.starts;
  const View<const BoxTree*> trees = search.node_trees.deviceTrees();
  const auto hits = search.hits;
  clearMasks<threads_per_block>(space, hits);
  Kokkos::parallel_for(
      "contact::BlockGhostSearch::query", rangePolicy(space, num_entries * threads_per_block),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const std::int64_t entry = i / threads_per_block;
        const int partner = partnerOf(starts, num_partners, entry);
        storeMask<threads_per_block>(hits(entry),
                                     query(blocks(entry), static_cast<int>(i % threads_per_block),
                                           trees(partner), node_offsets(partner)));
      });
}

void listHits(const exec_space& space, const PartnerLists& blocks_to_test,
              const View<const int*>& face_order, BlockGhostSearch& search) {
  const std::int64_t num_entries = blocks_to_test.size();
  growTo(space, search.positions, num_entries + 1);
  const auto positions = search.positions;
  auto& lists = search.faces_to_send;
  // Room for all lanes, so that the host does not wait for the number of hits.
  growTo(space, lists.rows, num_entries * block_size);
  launchScan(space, "contact::BlockGhostSearch::scan", CountMasked{search.hits}, num_entries,
             positions);
  const View<const int*> blocks = blocks_to_test.rows;
  const View<const unsigned*> hits = search.hits;
  const auto rows = lists.rows;
  Kokkos::parallel_for(
      "contact::BlockGhostSearch::list", rangePolicy(space, num_entries),
      KOKKOS_LAMBDA(const std::int64_t entry) {
        std::int64_t next = positions(entry);
        for (unsigned left = hits(entry); left != 0; left &= left - 1)
          rows(next++) = face_order(std::int64_t(blocks(entry)) * block_size + lowestBit(left));
      });
  offsetsOfKept(space, positions, search.starts, lists);
}

} // namespace

void searchLocalFacesAgainstRemoteNodes(const exec_space& space, const SweptBoxes& surface,
                                        const SurfaceClusters& clusters, double face_tolerance,
                                        const PartnerLists& blocks_to_test,
                                        const PartnerMessages& node_boxes,
                                        BlockGhostSearch& search) {
  const Region region("contact::searchLocalFacesAgainstRemoteNodes");
  const Region timer("contact::search::search_2");
  auto& lists = search.faces_to_send;
  lists.ranks = blocks_to_test.ranks;
  lists.offsets.assign(lists.ranks.size() + 1, 0);
  if (blocks_to_test.size() == 0 || node_boxes.receiveOffsets().back() == 0)
    return;
  const ClusterOrder& order = clusters.order();
  buildNodeTrees(space, node_boxes, order.origin, search);
  {
    const Region copies("contact::search::host_device_copies");
    copyToDevice(space, blocks_to_test.offsets, search.starts);
    copyToDevice(space, node_boxes.receiveOffsets(), search.node_offsets);
  }
  const BlockQuery query{clusters.faceTree(),       order.face_order,      surface.coordinates_old,
                         surface.coordinates_new,   surface.face_to_nodes, face_tolerance,
                         node_boxes.buffers.receive};
  findHits(space, blocks_to_test, query, search.node_offsets, search);
  listHits(space, blocks_to_test, order.face_order, search);
}

} // namespace brickwall::contact
