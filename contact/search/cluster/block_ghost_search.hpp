// Phase 5 of the cluster search: which faces of the candidate blocks overlap a node box of the rank they may be ghosted to.
// Every sender has its own tree; eight faces walk it at once; a face is done at its first hit.
#pragma once

#include "contact/search/cluster/cluster_candidates.hpp"
#include "contact/search/exchange/message_exchange.hpp"

namespace brickwall::contact {

struct BlockGhostSearch {
  PartnerLists faces_to_send; // L_ges, partners Q_rcv; rows by partner, then in the kept order

  std::vector<std::int64_t> num_boxes; // [sender]
  BoxForest node_trees; // one for each sender, boxes in the order of arrival
  // Per entry of blocks_to_test: lanes that are hit; how many, then the scan of that.
  View<unsigned*> hits{"contact::BlockGhostSearch::hits", 0};
  View<std::int64_t*> positions{"contact::BlockGhostSearch::positions", 0};
  View<std::int64_t*> starts{"contact::BlockGhostSearch::starts", 0}; // [partner + 1]
  View<std::int64_t*> node_offsets{"contact::BlockGhostSearch::node_offsets", 0}; // [sender + 1]
};

// Not collective. `node_boxes` are the messages of phase 4, senders in the order of blocks_to_test.ranks. Face f of a block
// listed for q is exported to q if and only if its box overlaps one of q's node boxes, in doubles: floats that are equal
// are looked up again. Cost is that of the blocks near q, about the logarithm of q's boxes for each.
void searchLocalFacesAgainstRemoteNodes(const exec_space& space, const SweptBoxes& surface,
                                        const SurfaceClusters& clusters, double face_tolerance,
                                        const PartnerLists& blocks_to_test,
                                        const PartnerMessages& node_boxes,
                                        BlockGhostSearch& search);

} // namespace brickwall::contact
