// Phase 3 of the cluster search: partners, node boxes to send (L_gns) and blocks of faces that may
// be ghosted (in place of L_gfs). A host tests whole clusters and blocks first, so that parts of
// the surface far from the partners cost almost nothing; a device tests all boxes side by side.
#pragma once

#include "contact/search/cluster/groups_to_search.hpp"
#include "contact/search/cluster/surface_clusters.hpp"
#include "contact/search/exchange/partner_lists.hpp"
#include "contact/search/exchange/rank_boxes.hpp"

#include <functional>

namespace brickwall::contact {

// Both lists hold all that overlaps in floats: everything that overlaps in doubles, and rarely a
// little more.
struct ClusterCandidates {
  PartnerLists nodes_to_send; // Q_snd; rows are owned nodes, in the kept order
  PartnerLists blocks_to_test; // Q_rcv; rows are blocks of the face tree's level 0, ascending

  // Scratch. Partners are those of the nodes, then those of the blocks.
  std::vector<FloatBounds> host_reach;
  View<FloatBounds*> reach{"contact::ClusterCandidates::reach", 0}; // [partner] of its rank box
  // [partner][group] those of a group of nodes or of blocks that are listed, as bits, and the
  // number of all that are listed before them.
  View<unsigned*> masks{"contact::ClusterCandidates::masks", 0};
  View<std::int64_t*> offsets{"contact::ClusterCandidates::offsets", 0};
  View<std::int64_t*> starts{"contact::ClusterCandidates::starts", 0}; // [partner + 1]
  std::vector<std::int64_t> host_starts;
};

// Not collective. r is in Q_snd(q) if and only if q is in Q_rcv(r), since both read the same rank
// boxes. `have_tested`, if any, is called if there are partners, before the host waits for the lists:
// kernels that it launches may read nodesNearPartners().
void findPartnersAndCandidates(const exec_space& space, const SurfaceClusters& clusters,
                               const RankBoxes& rank_boxes, ClusterCandidates& candidates,
                               const std::function<void()>& have_tested = {});

// The groups of nodes that are near partners, and so perhaps near ghosts.
GroupsNearPartners nodesNearPartners(const ClusterCandidates& candidates);

} // namespace brickwall::contact
