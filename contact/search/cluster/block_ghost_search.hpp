// Phase 5 of the cluster search: finds the faces of the candidate blocks that overlap a node box of
// the rank they may be ghosted to. Every sender has a tree of its own; eight faces traverse it
// together, on a device each alone; a face ends at its first hit.
#pragma once

#include "contact/search/cluster/cluster_candidates.hpp"
#include "contact/search/exchange/message_exchange.hpp"

namespace brickwall::contact {

struct BlockGhostSearch {
  PartnerLists faces_to_send; // L_ges, partners Q_rcv; rows by partner, then in the kept order

  std::vector<std::int64_t> num_boxes; // [sender]
  BoxForest node_trees; // one for each sender, boxes in the order of arrival
  // For each entry of blocks_to_test: the lanes that are hit, and the scan of their number.
  View<unsigned*> hits{"contact::BlockGhostSearch::hits", 0};
  View<std::int64_t*> positions{"contact::BlockGhostSearch::positions", 0};
  View<std::int64_t*> starts{"contact::BlockGhostSearch::starts", 0}; // [partner + 1]
  View<std::int64_t*> node_offsets{"contact::BlockGhostSearch::node_offsets", 0}; // [sender + 1]
};

// Not collective. `node_boxes` are the messages of phase 4, senders in the order of
// blocks_to_test.ranks. Face f of a block listed for q is exported to q if and only if its box
// overlaps one of the node boxes of q in doubles, which resolve ties in floats. The cost is
// proportional to the number of blocks near q and to the logarithm of the number of boxes of q.
void searchLocalFacesAgainstRemoteNodes(const exec_space& space, const SweptBoxes& surface,
                                        const SurfaceClusters& clusters, double face_tolerance,
                                        const PartnerLists& blocks_to_test,
                                        const PartnerMessages& node_boxes,
                                        BlockGhostSearch& search);

} // namespace brickwall::contact
