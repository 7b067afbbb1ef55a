// The reference of every search: plain serial loops over all pairs on the host, per sender. Oracle of the tests and
// baseline of the measurements; results and their order are those of the tree searches.
#pragma once

#include "contact/base/box.hpp"
#include "contact/search/exchange/node_box_exchange.hpp"
#include "contact/search/exchange/partner_lists.hpp"
#include "contact/surface/surface.hpp"

#include <vector>

namespace brickwall::contact {

// Searches 0 and 1: for each partner the rows of boxes[0, num_rows) that overlap its rank box.
void referenceCandidates(const exec_space& space, const View<const Box*>& boxes, int num_rows,
                         const std::vector<Box>& rank_boxes, PartnerLists& lists);

// Search 2: for each partner the candidate faces that overlap one of its node boxes. Returns the pairs found (a face
// counts once for each partner: the loop stops at its first).
std::int64_t referenceFaceGhosts(const exec_space& space, const View<const Box*>& face_boxes,
                                 const PartnerLists& faces_to_test, const RemoteNodeBoxes& remote,
                                 PartnerLists& faces_to_send);

// Local search: face boxes are own faces, then ghosts. Sets `row_offsets` [node + 1] and pairs.faces, rows
// unsorted.
void referencePairs(const exec_space& space, const Surface& surface, const GhostFaces& ghosts,
                    const View<const Box*>& node_boxes, const View<const Box*>& face_boxes,
                    bool drop_same_body, View<std::int64_t*>& row_offsets, CandidatePairs& pairs);

} // namespace brickwall::contact
