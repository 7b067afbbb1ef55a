// Search 2 of the paper (phase 5) by one tree of the node boxes of all partners, whose results are
// filtered by partner.
#pragma once

#include "contact/search/exchange/node_box_exchange.hpp"
#include "contact/search/spatial/bvh_query.hpp"

namespace brickwall::contact {

// Scratch of the search.
struct FaceGhostSearch {
  Bvh tree; // of the node boxes of all senders
  QueryOrder order;
  QueryResults results;
  View<std::int64_t*> positions{"contact::FaceGhostSearch::positions", 0}; // flags, then their scan
  View<std::int64_t*> starts{"contact::FaceGhostSearch::starts", 0}; // [partner + 1]
  SortedKeys by_id;
};

// Face f of L_gfs^q is listed for q if and only if its box overlaps a box of L_gnr^q. All q share
// one tree and one search; pairs with boxes of other ranks are dropped, and a face is listed once
// for each q. Sets rows and offsets of `faces_to_send`. Returns the number of overlapping pairs
// before the filter. Not collective.
std::int64_t findFacesToSend(const exec_space& space, const View<const Box*>& face_boxes,
                             const PartnerLists& faces_to_test, const RemoteNodeBoxes& remote,
                             FaceGhostSearch& search, PartnerLists& faces_to_send);

// Sorts the rows of each partner by face id, the order in which its ghosts arrive; the order of
// local faces may differ.
void orderByFaceId(const exec_space& space, const View<const global_id*>& ids,
                   FaceGhostSearch& search, PartnerLists& lists);

} // namespace brickwall::contact
