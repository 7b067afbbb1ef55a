// Phase 5: which candidate faces overlap a node box of the rank they may be ghosted to; the paper's search 2.
#pragma once

#include "contact/search/exchange/node_box_exchange.hpp"
#include "contact/search/paper/ghosting_candidates.hpp"
#include "contact/search/spatial/bvh_query.hpp"

namespace brickwall::contact {

struct FaceGhostSearch {
  PartnerLists faces_to_send; // L_ges, partners Q_rcv; rows by partner, then face id
  std::int64_t overlapping_pairs = 0; // found in the merged tree, before the filter

  Bvh tree; // of the node boxes of all senders
  QueryOrder order;
  QueryResults results;
  View<std::int64_t*> positions{"contact::FaceGhostSearch::positions", 0}; // flags, then their scan
  View<std::int64_t*> starts{"contact::FaceGhostSearch::starts", 0}; // [partner + 1]
  SortedKeys by_id;
};

// Not collective. Face f of L_gfs^q is exported to q if and only if its box overlaps a box of L_gnr^q. All q share one
// tree and one search; pairs with another q are dropped and a face is listed once for each q.
void searchLocalFacesAgainstRemoteNodes(const exec_space& space, const Surface& surface,
                                        const SurfaceBoxes& boxes,
                                        const PartnerLists& faces_to_test,
                                        const RemoteNodeBoxes& remote, SearchMethod method,
                                        FaceGhostSearch& search);

} // namespace brickwall::contact
