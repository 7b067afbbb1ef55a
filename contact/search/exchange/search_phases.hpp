// The phases of the global search (paper, Fig. 4) as one search method carries them out, with the
// local search that follows. GlobalSearch calls them in order; phases 2 and 6 are the same for all
// methods and its own.
#pragma once

#include "contact/search/exchange/partner_lists.hpp"
#include "contact/search/exchange/rank_boxes.hpp"

#include <functional>

namespace brickwall::contact {

// One implementation for each SearchMethod; an object holds the buffers of its method only. Every
// call of a step gets the same surface and configuration.
class SearchPhases {
public:
  SearchPhases() = default;
  SearchPhases(const SearchPhases&) = delete;
  SearchPhases& operator=(const SearchPhases&) = delete;
  virtual ~SearchPhases() = default;

  // Phase 1: boxes of nodes and faces over the step. Invalid coordinates are counted; the ranks
  // decide together in phase 2.
  virtual OwnRankBoxes constructBoxes(const exec_space& space, const SweptBoxes& surface,
                                      const SearchConfig& config) = 0;
  // The same in two parts, of which the second waits for the device; kernels may use the boxes
  // after the first. False, without effect, if the method constructs boxes at once.
  virtual bool launchBoxes(const exec_space&, const SweptBoxes&, const SearchConfig&) {
    return false;
  }
  virtual OwnRankBoxes readBoxes(const exec_space&) { return {}; }
  // Phase 3: the partners Q_snd and Q_rcv, the nodes whose boxes are sent (L_gns) and the faces
  // that may be ghosted (L_gfs). Rank r is in Q_snd of q if and only if q is in Q_rcv of r, since
  // both compare the same rank boxes. If findPairs() is called after phase 6 (`pairs_follow`), a
  // device may begin it with nodes that are near no partner. Not collective.
  virtual void findPartnersAndCandidates(const exec_space& space, const SweptBoxes& surface,
                                         const RankBoxes& rank_boxes, const SearchConfig& config,
                                         bool pairs_follow) = 0;
  // Phase 4: the node boxes of the partners (L_gnr). Collective among partners.
  virtual void exchangeNodeBoxes(const exec_space& space, MPI_Comm comm, const SweptBoxes& surface,
                                 const SearchConfig& config) = 0;
  // Phase 5: the faces to send (L_ges): face f of L_gfs^q if and only if its box overlaps a box of
  // L_gnr^q. Not collective.
  virtual void searchLocalFacesAgainstRemoteNodes(const exec_space& space,
                                                  const SweptBoxes& surface,
                                                  const SearchConfig& config) = 0;

  // The candidate pairs of the step in pairs(), all but `step_test`. Not collective.
  virtual void findPairs(const exec_space& space, const SweptBoxes& surface,
                         const GhostFaces& ghosts, const SearchConfig& config) = 0;

  virtual const PartnerLists& nodesToSend() const = 0; // ranks Q_snd
  virtual const PartnerLists& facesToTest() const = 0; // ranks Q_rcv; rows are the method's own
  virtual const PartnerLists& facesToSend() const = 0; // L_ges, ranks Q_rcv
  virtual SearchStatistics countWork() const = 0; // of phases 3 and 5
  virtual bool announcesSizes() const = 0; // in a message before that of phase 6
  virtual bool keepsRankBoxes() const { return false; } // otherwise phase 2 is that of the paper

  // Something of the surface besides its coordinates has changed in place.
  virtual void forget() {}
  virtual std::int64_t numOrderings() const { return 0; } // of the surface, since the start

  // Launches work that does not need the pairs; findPairs() may call it before it waits for the
  // device.
  std::function<void()> meanwhile;

  CandidatePairs& pairs() { return _pairs; }
  const CandidatePairs& pairs() const { return _pairs; }

protected:
  CandidatePairs _pairs;
};

} // namespace brickwall::contact
