// Phase 3: partners, node boxes to send (L_gns) and faces that may be ghosted (L_gfs); the paper's searches 0 and 1.
#pragma once

#include "contact/search/exchange/partner_lists.hpp"
#include "contact/search/exchange/rank_boxes.hpp"
#include "contact/search/spatial/bvh_query.hpp"
#include "contact/surface/construct_boxes.hpp"

namespace brickwall::contact {

// Scratch of one search of local boxes against the rank boxes of others.
struct RankBoxSearch {
  std::vector<Box> host_boxes;
  View<Box*> rank_boxes{"contact::RankBoxSearch::rank_boxes", 0}; // [partner]
  Bvh tree;
  QueryResults results;
  SortedKeys pairs; // key = partner * rows + row
  View<std::int64_t*> starts{"contact::RankBoxSearch::starts", 0}; // [partner + 1] in pairs
};

struct GhostingCandidates {
  PartnerLists nodes_to_send; // ranks: Q_snd = {q : Bbar_n meets Bbar_f^q}, rows: L_gns^q
  PartnerLists faces_to_test; // ranks: Q_rcv = {q : Bbar_f meets Bbar_n^q}, rows: L_gfs^q

  RankBoxSearch node_search, face_search;
};

// Not collective. r is in Q_snd(q) if and only if q is in Q_rcv(r), since both read the same rank boxes.
void findPartnersAndCandidates(const exec_space& space, const Surface& surface,
                               const SurfaceBoxes& boxes, const RankBoxes& rank_boxes,
                               SearchMethod method, GhostingCandidates& candidates);

} // namespace brickwall::contact
