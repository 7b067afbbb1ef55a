// The search by clusters: the surface is kept in order, with boxes in blocks of eight and one tree
// per sender; a face ends at its first hit. One message per partner in phases 4 and 6.
// Equations: theory.md, section 3.
#pragma once

#include "contact/search/cluster/block_ghost_search.hpp"
#include "contact/search/cluster/cluster_candidates.hpp"
#include "contact/search/cluster/cluster_pairs.hpp"
#include "contact/search/cluster/surface_clusters.hpp"
#include "contact/search/exchange/search_phases.hpp"

namespace brickwall::contact {

class ClusterSearch final : public SearchPhases {
public:
  OwnRankBoxes constructBoxes(const exec_space& space, const SweptBoxes& surface,
                              const SearchConfig& config) override;
  bool launchBoxes(const exec_space& space, const SweptBoxes& surface,
                   const SearchConfig& config) override;
  OwnRankBoxes readBoxes(const exec_space& space) override;
  void findPartnersAndCandidates(const exec_space& space, const SweptBoxes& surface,
                                 const RankBoxes& rank_boxes, const SearchConfig& config,
                                 bool pairs_follow) override;
  void exchangeNodeBoxes(const exec_space& space, MPI_Comm comm, const SweptBoxes& surface,
                         const SearchConfig& config) override;
  void searchLocalFacesAgainstRemoteNodes(const exec_space& space, const SweptBoxes& surface,
                                          const SearchConfig& config) override;
  void findPairs(const exec_space& space, const SweptBoxes& surface, const GhostFaces& ghosts,
                 const SearchConfig& config) override;

  const PartnerLists& nodesToSend() const override { return _candidates.nodes_to_send; }
  const PartnerLists& facesToTest() const override { return _candidates.blocks_to_test; }
  const PartnerLists& facesToSend() const override { return _ghost_search.faces_to_send; }
  SearchStatistics countWork() const override;
  bool announcesSizes() const override { return false; }
  bool keepsRankBoxes() const override { return true; }
  void forget() override { _clusters.orderAgain(); }
  std::int64_t numOrderings() const override { return _clusters.numOrderings(); }

private:
  SurfaceClusters _clusters; // phase 1
  ClusterCandidates _candidates; // phase 3
  PartnerMessages _node_boxes; // phase 4
  BlockGhostSearch _ghost_search; // phase 5
  ClusterPairs _cluster_pairs;
};

} // namespace brickwall::contact
