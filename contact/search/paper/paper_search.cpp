#include "contact/search/paper/paper_search.hpp"

#include "contact/base/region.hpp"

namespace brickwall::contact {
namespace {

// Joins the boxes of own faces and ghosts in one array, and includes those of the ghosts in `all`.
void appendGhostBoxes(const exec_space& space, const View<const Box*>& own, int num_own,
                      const GhostFaces& ghosts, double tolerance, const View<Box*>& joined,
                      Box& all) {
  const auto x_old = ghosts.coordinates_old, x_new = ghosts.coordinates_new;
  Box ghost_box;
  Kokkos::parallel_for(
      "contact::PaperSearch::own_boxes", rangePolicy(space, num_own),
      KOKKOS_LAMBDA(const std::int64_t face) { joined(face) = own(face); });
  Kokkos::parallel_reduce(
      "contact::PaperSearch::ghost_boxes", rangePolicy(space, ghosts.count),
      KOKKOS_LAMBDA(const std::int64_t ghost, Box& sum) {
        const Box box = ghostBox(x_old, x_new, ghost, tolerance);
        joined(num_own + ghost) = box;
        sum.include(box);
      },
      PlusReducer<Box>(ghost_box));
  all.include(ghost_box);
}

void sortRows(const exec_space& space, const PairRules<memory_space>& rules,
              const CandidatePairs& pairs) {
  const auto faces = pairs.faces;
  Kokkos::parallel_for(
      "contact::PaperSearch::sort_rows", rangePolicy(space, pairs.num_rows),
      KOKKOS_LAMBDA(const std::int64_t row) {
        const std::int64_t first = pairs.begin(row), n = pairs.end(row) - first;
        if (n > 1)
          sortRow(&faces(first), n, [&](const int a, const int b) { return rules.before(a, b); });
      });
}

} // namespace

OwnRankBoxes PaperSearch::constructBoxes(const exec_space& space, const SweptBoxes& surface,
                                         const SearchConfig& config) {
  contact::constructBoxes(space, surface, config, _boxes);
  return _boxes;
}

void PaperSearch::findPartnersAndCandidates(const exec_space& space, const SweptBoxes& surface,
                                            const RankBoxes& rank_boxes, const SearchConfig&,
                                            bool) {
  const Region region("contact::findPartnersAndCandidates");
  const Region timer("contact::search::searches_0_and_1");
  listCandidates(space, _boxes.node_boxes, surface.num_nodes, rank_boxes.near_nodes, _node_search,
                 _nodes_to_send);
  listCandidates(space, _boxes.face_boxes, surface.num_faces, rank_boxes.near_faces, _face_search,
                 _faces_to_test);
}

// The boxes of `partners` are those of the other kind: of faces for nodes, of nodes for faces.
void PaperSearch::listCandidates(const exec_space& space, const View<const Box*>& boxes,
                                 int num_rows, const NearRanks& partners, RankBoxSearch& search,
                                 PartnerLists& lists) {
  lists.ranks = partners.ranks;
  lists.offsets.assign(lists.ranks.size() + 1, 0);
  if (!lists.ranks.empty())
    findCandidates(space, boxes, num_rows, partners.boxes, search, lists);
}

void PaperSearch::exchangeNodeBoxes(const exec_space& space, MPI_Comm comm, const SweptBoxes&,
                                    const SearchConfig&) {
  contact::exchangeNodeBoxes(space, comm, _boxes, _nodes_to_send, _faces_to_test.ranks,
                             _remote_nodes);
}

void PaperSearch::searchLocalFacesAgainstRemoteNodes(const exec_space& space,
                                                     const SweptBoxes& surface,
                                                     const SearchConfig&) {
  const Region region("contact::searchLocalFacesAgainstRemoteNodes");
  const Region timer("contact::search::search_2");
  _faces_to_send.ranks = _faces_to_test.ranks;
  _faces_to_send.offsets.assign(_faces_to_send.ranks.size() + 1, 0);
  _overlapping_pairs = 0;
  if (_faces_to_test.size() == 0 || _remote_nodes.size() == 0)
    return;
  _overlapping_pairs = findFaces(space);
  orderByFaceId(space, surface.face_ids, _ghost_search, _faces_to_send);
}

void PaperSearch::findPairs(const exec_space& space, const SweptBoxes& surface,
                            const GhostFaces& ghosts, const SearchConfig& config) {
  View<const Box*> face_boxes = _boxes.face_boxes;
  Box all = _boxes.face_box;
  if (ghosts.count > 0) {
    growTo(space, _face_boxes, surface.num_faces + ghosts.count);
    appendGhostBoxes(space, _boxes.face_boxes, surface.num_faces, ghosts, config.face_tolerance,
                     _face_boxes, all);
    face_boxes = _face_boxes;
  }
  findRows(space, surface, ghosts, face_boxes, all, config.drop_same_body);
  layOutRowsByNode(space, surface.num_nodes, _offsets, _pairs);
  _pairs.version = 0;
  sortRows(space, PairRules<memory_space>(surface, ghosts, config.drop_same_body), _pairs);
}

void PaperSearch::findCandidates(const exec_space& space, const View<const Box*>& boxes,
                                 int num_rows, const std::vector<Box>& rank_boxes,
                                 RankBoxSearch& search, PartnerLists& lists) {
  findGhostingCandidates(space, boxes, num_rows, rank_boxes, search, lists);
}

std::int64_t PaperSearch::findFaces(const exec_space& space) {
  return findFacesToSend(space, _boxes.face_boxes, _faces_to_test, _remote_nodes, _ghost_search,
                         _faces_to_send);
}

void PaperSearch::findRows(const exec_space& space, const SweptBoxes& surface,
                           const GhostFaces& ghosts, const View<const Box*>& face_boxes,
                           const Box& all, bool drop_same_body) {
  findPairsByTree(
      space, _boxes.node_boxes, surface.num_nodes, face_boxes, surface.num_faces + ghosts.count,
      all, PairRules<memory_space>(surface, ghosts, drop_same_body), _tree_pairs, _offsets, _pairs);
}

SearchStatistics PaperSearch::countWork() const {
  SearchStatistics counts;
  counts.node_boxes_sent = _nodes_to_send.size();
  counts.candidate_faces = _faces_to_test.size();
  counts.overlapping_pairs = _overlapping_pairs;
  return counts;
}

} // namespace brickwall::contact
