#include "contact/search/global_search.hpp"

#include "contact/base/region.hpp"
#include "contact/search/exchange/ghost_corner_values.hpp"

#include <cmath>

namespace brickwall::contact {

GlobalSearch::GlobalSearch(MPI_Comm comm, const SearchConfig& config)
    : _comm(comm), _config(config) {
  for (const double tolerance : {config.node_tolerance, config.face_tolerance})
    if (!(tolerance >= 0) || !std::isfinite(tolerance))
      throw InputError("GlobalSearch: tolerance is " + std::to_string(tolerance) +
                       ", needs a finite length >= 0");
}

const GhostFaces& GlobalSearch::findGhosts(const exec_space& space, const Surface& surface) {
  const Region region("findGhosts");
  if (_config.method == SearchMethod::cluster)
    findByClusters(space, surface);
  else
    findByBoxes(space, surface);
  return _migration.ghosts;
}

void GlobalSearch::findByClusters(const exec_space& space, const Surface& surface) {
  const PartnerLists& nodes_to_send = _cluster_candidates.nodes_to_send; // L_gns, Q_snd
  const PartnerLists& blocks_to_test = _cluster_candidates.blocks_to_test; // L_gfs, Q_rcv
  _clusters.update(space, surface, _config);
  exchangeRankBoxes(_comm, surface, _clusters, _rank_boxes);
  findPartnersAndCandidates(space, _clusters, _rank_boxes, _cluster_candidates);
  exchangeNodeBoxes(space, _comm, surface, _config.node_tolerance, nodes_to_send,
                    blocks_to_test.ranks, _node_boxes);
  searchLocalFacesAgainstRemoteNodes(space, surface, _clusters, _config.face_tolerance,
                                     blocks_to_test, _node_boxes, _block_search);
  migrateFaces(space, _comm, surface, _block_search.faces_to_send, nodes_to_send.ranks,
               _rank_boxes.num_attributes, _config.method, _migration);
}

void GlobalSearch::findByBoxes(const exec_space& space, const Surface& surface) {
  const PartnerLists& nodes_to_send = _candidates.nodes_to_send; // L_gns, Q_snd
  const PartnerLists& faces_to_test = _candidates.faces_to_test; // L_gfs, Q_rcv
  constructBoxes(space, surface, _config, _boxes);
  exchangeRankBoxes(_comm, surface, _boxes, _rank_boxes);
  findPartnersAndCandidates(space, surface, _boxes, _rank_boxes, _config.method, _candidates);
  exchangeNodeBoxes(space, _comm, _boxes, nodes_to_send, faces_to_test.ranks, _remote_nodes);
  searchLocalFacesAgainstRemoteNodes(space, surface, _boxes, faces_to_test, _remote_nodes,
                                     _config.method, _ghost_search);
  migrateFaces(space, _comm, surface, _ghost_search.faces_to_send, nodes_to_send.ranks,
               _rank_boxes.num_attributes, _config.method, _migration);
}

void GlobalSearch::reverseSum(const exec_space& space, const View<const int* [4]>& face_to_nodes,
                              const View<const std::int64_t* [12]>& ghost_values,
                              const View<std::int64_t* [3]>& node_values) {
  reverseSumGhostValues(space, _comm, facesToSend(), face_to_nodes, ghost_values, _migration,
                        node_values);
}

void GlobalSearch::forward(const exec_space& space, const Surface& surface,
                           const View<const double* [3]>& node_values,
                           const View<double* [12]>& ghost_values) {
  forwardCornerValues(space, _comm, facesToSend(), surface.face_to_nodes, node_values, _migration,
                      ghost_values);
}

void GlobalSearch::forwardCoordinates(const exec_space& space, const Surface& surface) {
  sendCoordinates(space, _comm, facesToSend(), surface, _migration);
}

std::vector<SentFace> GlobalSearch::sentFaces(const exec_space& space,
                                              const Surface& surface) const {
  const PartnerLists& lists = facesToSend();
  const View<const int*> faces = lists.rows;
  const View<const global_id*> ids = surface.face_ids;
  const auto ids_sent =
      allocate<View<global_id*>>(space, "contact::GlobalSearch::sent_faces", lists.size());
  Kokkos::parallel_for(
      "contact::GlobalSearch::sentFaces", rangePolicy(space, lists.size()),
      KOKKOS_LAMBDA(const std::int64_t i) { ids_sent(i) = ids(faces(i)); });
  std::vector<global_id> host_ids;
  copyToHost(space, ids_sent, lists.size(), host_ids);
  std::vector<SentFace> sent;
  sent.reserve(host_ids.size());
  for (std::size_t p = 0; p < lists.ranks.size(); ++p)
    for (std::int64_t i = lists.offsets[p]; i < lists.offsets[p + 1]; ++i)
      sent.push_back({host_ids[static_cast<std::size_t>(i)], lists.ranks[p]});
  return sent;
}

SearchStatistics GlobalSearch::statistics() const {
  SearchStatistics counts;
  counts.num_partners = _migration.messages.numPartners();
  counts.faces_sent = facesToSend().size();
  counts.num_ghosts = _migration.ghosts.count;
  if (_config.method == SearchMethod::cluster) {
    counts.node_boxes_sent = _cluster_candidates.nodes_to_send.size();
    counts.candidate_faces = _cluster_candidates.blocks_to_test.size() * block_size;
    counts.overlapping_pairs = counts.faces_sent; // a face ends at its first hit
  } else {
    counts.node_boxes_sent = _candidates.nodes_to_send.size();
    counts.candidate_faces = _candidates.faces_to_test.size();
    counts.overlapping_pairs = _ghost_search.overlapping_pairs;
  }
  return counts;
}

} // namespace brickwall::contact
