// Searches 0 and 1 of the paper (phase 3) by a tree of the rank boxes: node boxes to send (L_gns)
// and faces that may be ghosted (L_gfs).
#pragma once

#include "contact/search/exchange/partner_lists.hpp"
#include "contact/search/spatial/bvh_query.hpp"

namespace brickwall::contact {

// Scratch of one search of local boxes against the rank boxes of the partners.
struct RankBoxSearch {
  View<Box*> rank_boxes{"contact::RankBoxSearch::rank_boxes", 0}; // [partner]
  Bvh tree;
  QueryResults results;
  SortedKeys pairs; // key = partner * rows + row
  View<std::int64_t*> starts{"contact::RankBoxSearch::starts", 0}; // [partner + 1] in pairs
};

// For each partner (lists.ranks) the rows of boxes [0, num_rows) that overlap its rank box,
// ascending. Not collective.
void findGhostingCandidates(const exec_space& space, const View<const Box*>& boxes, int num_rows,
                            const std::vector<Box>& rank_boxes, RankBoxSearch& search,
                            PartnerLists& lists);

} // namespace brickwall::contact
