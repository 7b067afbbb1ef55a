#include "contact/search/global_search.hpp"

#include "contact/base/region.hpp"
#include "contact/search/cluster/cluster_search.hpp"
#include "contact/search/exchange/ghost_exchange.hpp"
#include "contact/search/paper/reference_search.hpp"

namespace brickwall::contact {

std::unique_ptr<SearchPhases> makeSearchPhases(SearchMethod method) {
  switch (method) {
  case SearchMethod::paper:
    return std::make_unique<PaperSearch>();
  case SearchMethod::reference:
    return std::make_unique<ReferenceSearch>();
  case SearchMethod::cluster:
    break;
  }
  return std::make_unique<ClusterSearch>();
}

GlobalSearch::GlobalSearch(const Communicator& comm, const SearchConfig& config)
    : _comm(comm), _config(config), _phases(makeSearchPhases(config.method)) {
  checkSearchConfig(_comm, "GlobalSearch", config);
}

// The input is checked where it is new, and the rank boxes are exchanged where they do not hold.
// The one reduction of a call in which nothing is new.
void GlobalSearch::updateRankBoxes(const exec_space& space, const SweptBoxes& surface,
                                   bool may_wait_later) {
  OwnRankBoxes own;
  bool is_same = _check.isSame(space, surface);
  if (is_same)
    _check.startLook(space, surface);
  const bool has_boxes = _has_agreed && is_same;
  _awaits_boxes = may_wait_later && has_boxes && _rank_boxes.areKnown() &&
                  _phases->launchBoxes(space, surface, _config);
  if (_awaits_boxes)
    return;
  if (has_boxes)
    own = _phases->constructBoxes(space, surface, _config);
  if (is_same) // the host has waited for the boxes
    is_same = _check.looksSame(space);
  const bool is_known = has_boxes && is_same;
  int holds[2] = {is_known,
                  is_known && _phases->keepsRankBoxes() && _rank_boxes.hold(surface, own)};
  if (sizeOf(_comm) > 1)
    allReduce(_comm, holds, 2, MPI_MIN);
  if (holds[0] == 0)
    checkInput(space, surface, is_same);
  if (!is_known)
    own = _phases->constructBoxes(space, surface, _config);
  if (holds[1] == 0)
    exchangeBoxes(surface, own);
}

void GlobalSearch::finishGhosts(const exec_space& space, const SweptBoxes& surface) {
  if (!_awaits_boxes)
    return;
  _awaits_boxes = false;
  const OwnRankBoxes own = _phases->readBoxes(space);
  if (!_check.looksSame(space))
    checkInput(space, surface, false);
  if (!_rank_boxes.hold(surface, own))
    exchangeBoxes(surface, own);
}

void GlobalSearch::exchangeBoxes(const SweptBoxes& surface, const OwnRankBoxes& own) {
  exchangeRankBoxes(_comm, surface, own, _phases->keepsRankBoxes(), _rank_boxes);
  ++_num_rank_box_exchanges;
}

void GlobalSearch::checkInput(const exec_space& space, const SweptBoxes& surface, bool is_same) {
  const Region region("contact::GlobalSearch::checkInput");
  checkSearchConfig(_comm, "GlobalSearch", _config);
  _has_agreed = true;
  _check.update(space, _comm, "GlobalSearch", surface, is_same);
  if (!is_same)
    _phases->forget(); // a surface that is checked anew is put in order anew
}

const GhostFaces& GlobalSearch::findGhosts(const exec_space& space, const SweptBoxes& surface,
                                           bool pairs_follow) {
  const Region region("contact::findGhosts");
  updateRankBoxes(space, surface, pairs_follow && sizeOf(_comm) == 1);
  _phases->findPartnersAndCandidates(space, surface, _rank_boxes, _config, pairs_follow);
  _phases->exchangeNodeBoxes(space, _comm, surface, _config);
  _phases->searchLocalFacesAgainstRemoteNodes(space, surface, _config);
  migrateFaces(space, _comm, surface, _phases->facesToSend(), _phases->nodesToSend().ranks,
               _rank_boxes.num_attributes, _phases->announcesSizes(), _migration);
  return _migration.ghosts;
}

void GlobalSearch::reverseSum(const exec_space& space, const View<const int* [4]>& face_to_nodes,
                              const View<const std::int64_t* [12]>& ghost_values,
                              const View<std::int64_t* [3]>& node_values) {
  contact::reverseSum(space, _comm, _phases->facesToSend(), face_to_nodes, ghost_values, _migration,
                      node_values);
}

void GlobalSearch::forward(const exec_space& space, const SweptBoxes& surface,
                           const View<const double* [3]>& node_values,
                           const View<double* [12]>& ghost_values) {
  contact::forward(space, _comm, _phases->facesToSend(), surface.face_to_nodes, node_values,
                   _migration, ghost_values);
}

void GlobalSearch::forwardCoordinates(const exec_space& space, const SweptBoxes& surface) {
  contact::forwardCoordinates(space, _comm, _phases->facesToSend(), surface, _migration);
}

std::vector<SentFace> GlobalSearch::sentFaces(const exec_space& space,
                                              const SweptBoxes& surface) const {
  const PartnerLists& lists = _phases->facesToSend();
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
  SearchStatistics counts = _phases->countWork();
  counts.num_partners = _migration.messages.numPartners();
  counts.faces_sent = _phases->facesToSend().size();
  counts.num_ghosts = _migration.ghosts.count;
  return counts;
}

} // namespace brickwall::contact
