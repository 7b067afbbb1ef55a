// The search of the paper (sections 4 and 5): Morton codes, radix sort, Karras tree, one merged
// tree over all senders.
#pragma once

#include "contact/search/exchange/node_box_exchange.hpp"
#include "contact/search/exchange/search_phases.hpp"
#include "contact/search/paper/face_ghost_search.hpp"
#include "contact/search/paper/ghosting_candidates.hpp"
#include "contact/search/paper/tree_pairs.hpp"

namespace brickwall::contact {

// Ghosts come by owner rank, then by face id. A steady step allocates nothing.
class PaperSearch : public SearchPhases {
public:
  OwnRankBoxes constructBoxes(const exec_space& space, const SweptBoxes& surface,
                              const SearchConfig& config) override;
  void findPartnersAndCandidates(const exec_space& space, const SweptBoxes& surface,
                                 const RankBoxes& rank_boxes, const SearchConfig& config,
                                 bool pairs_follow) override;
  void exchangeNodeBoxes(const exec_space& space, MPI_Comm comm, const SweptBoxes& surface,
                         const SearchConfig& config) override;
  void searchLocalFacesAgainstRemoteNodes(const exec_space& space, const SweptBoxes& surface,
                                          const SearchConfig& config) override;
  void findPairs(const exec_space& space, const SweptBoxes& surface, const GhostFaces& ghosts,
                 const SearchConfig& config) override;

  const PartnerLists& nodesToSend() const override { return _nodes_to_send; }
  const PartnerLists& facesToTest() const override { return _faces_to_test; }
  const PartnerLists& facesToSend() const override { return _faces_to_send; }
  SearchStatistics countWork() const override;
  bool announcesSizes() const override { return true; }

protected:
  // The searches themselves, as findGhostingCandidates(), findFacesToSend() and findPairsByTree();
  // the reference search replaces them by loops over all pairs.
  virtual void findCandidates(const exec_space& space, const View<const Box*>& boxes, int num_rows,
                              const std::vector<Box>& rank_boxes, RankBoxSearch& search,
                              PartnerLists& lists);
  virtual std::int64_t findFaces(const exec_space& space);
  virtual void findRows(const exec_space& space, const SweptBoxes& surface,
                        const GhostFaces& ghosts, const View<const Box*>& face_boxes,
                        const Box& all, bool drop_same_body);

  SurfaceBoxes _boxes; // phase 1
  PartnerLists _nodes_to_send, _faces_to_test; // phase 3
  RemoteNodeBoxes _remote_nodes; // phase 4
  PartnerLists _faces_to_send; // phase 5
  View<std::int64_t*> _offsets{"contact::PaperSearch::offsets", 0}; // [node + 1] of the pairs

private:
  void listCandidates(const exec_space& space, const View<const Box*>& boxes, int num_rows,
                      const NearRanks& partners, RankBoxSearch& search, PartnerLists& lists);

  RankBoxSearch _node_search, _face_search;
  FaceGhostSearch _ghost_search;
  std::int64_t _overlapping_pairs = 0; // found by search 2
  View<Box*> _face_boxes{"contact::PaperSearch::face_boxes", 0}; // [own faces, then ghosts]
  TreePairs _tree_pairs;
};

} // namespace brickwall::contact
