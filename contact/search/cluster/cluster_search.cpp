#include "contact/search/cluster/cluster_search.hpp"

#include "contact/base/region.hpp"
#include "contact/search/exchange/node_box_exchange.hpp"

namespace brickwall::contact {

OwnRankBoxes ClusterSearch::constructBoxes(const exec_space& space, const SweptBoxes& surface,
                                           const SearchConfig& config) {
  _clusters.update(space, surface, config);
  return _clusters.rankBoxes();
}

bool ClusterSearch::launchBoxes(const exec_space& space, const SweptBoxes& surface,
                                const SearchConfig& config) {
  if (!fills_lanes)
    _clusters.launchUpdate(space, surface, config);
  return !fills_lanes;
}

OwnRankBoxes ClusterSearch::readBoxes(const exec_space& space) {
  _clusters.readRankBoxes(space);
  return _clusters.rankBoxes();
}

// Pairs of own nodes and faces are found while candidates, boxes and ghosts are on their way.
void ClusterSearch::findPartnersAndCandidates(const exec_space& space, const SweptBoxes& surface,
                                              const RankBoxes& rank_boxes,
                                              const SearchConfig& config, bool pairs_follow) {
  _cluster_pairs.forgetBegun();
  contact::findPartnersAndCandidates(space, _clusters, rank_boxes, _candidates, [&] {
    if (pairs_follow) {
      const Region timer("contact::search::local_search");
      _cluster_pairs.begin(space, surface, _clusters, config, nodesNearPartners(_candidates),
                           _pairs);
    }
  });
}

void ClusterSearch::exchangeNodeBoxes(const exec_space& space, MPI_Comm comm,
                                      const SweptBoxes& surface, const SearchConfig& config) {
  contact::exchangeNodeBoxes(space, comm, surface, config.node_tolerance, _candidates.nodes_to_send,
                             _candidates.blocks_to_test.ranks, _node_boxes);
}

void ClusterSearch::searchLocalFacesAgainstRemoteNodes(const exec_space& space,
                                                       const SweptBoxes& surface,
                                                       const SearchConfig& config) {
  contact::searchLocalFacesAgainstRemoteNodes(space, surface, _clusters, config.face_tolerance,
                                              _candidates.blocks_to_test, _node_boxes,
                                              _ghost_search);
}

void ClusterSearch::findPairs(const exec_space& space, const SweptBoxes& surface,
                              const GhostFaces& ghosts, const SearchConfig& config) {
  _clusters.noteSearch(
      _cluster_pairs.find(space, surface, ghosts, _clusters, config, meanwhile, _pairs));
}

SearchStatistics ClusterSearch::countWork() const {
  SearchStatistics counts;
  counts.node_boxes_sent = _candidates.nodes_to_send.size();
  counts.candidate_faces = _candidates.blocks_to_test.size() * block_size;
  counts.overlapping_pairs = facesToSend().size(); // a face ends at its first hit
  return counts;
}

} // namespace brickwall::contact
