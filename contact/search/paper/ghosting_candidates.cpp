#include "contact/search/paper/ghosting_candidates.hpp"

#include "contact/base/region.hpp"
#include "contact/search/paper/reference_search.hpp"

namespace brickwall::contact {
namespace {

struct OverlapsRankBox {
  View<const Box*> boxes;
  View<const Box*> rank_boxes;
  KOKKOS_INLINE_FUNCTION OverlapsRow operator()(int row) const {
    return {boxes(row), rank_boxes.data()};
  }
};

// Results by row become lists by partner: one key (partner, row) for each, sorted.
void listByPartner(const exec_space& space, std::int64_t num_rows, RankBoxSearch& search,
                   PartnerLists& lists) {
  const auto num_partners = static_cast<std::int64_t>(lists.ranks.size());
  const std::int64_t num_pairs = search.results.num_rows;
  search.pairs.grow(space, num_pairs);
  const auto keys = search.pairs.keys;
  const auto begin = search.results.begin, count = search.results.count;
  const auto partners = search.results.items;
  Kokkos::parallel_for(
      "contact::ghostingCandidates::keys", rangePolicy(space, num_rows),
      KOKKOS_LAMBDA(const std::int64_t row) {
        for (std::int64_t i = begin(row); i < begin(row) + count(row); ++i)
          keys(i) = static_cast<std::uint64_t>(partners(i) * num_rows + row);
      });
  sortByKey(space, num_pairs, bitsFor(static_cast<std::uint64_t>(num_partners * num_rows)),
            search.pairs);

  growTo(space, lists.rows, num_pairs);
  growTo(space, search.starts, num_partners + 1);
  const auto sorted = search.pairs.keys;
  const auto rows = lists.rows;
  const auto starts = search.starts;
  Kokkos::parallel_for(
      "contact::ghostingCandidates::rows", rangePolicy(space, num_pairs),
      KOKKOS_LAMBDA(const std::int64_t i) {
        rows(i) = static_cast<int>(sorted(i) % static_cast<std::uint64_t>(num_rows));
      });
  Kokkos::parallel_for(
      "contact::ghostingCandidates::starts", rangePolicy(space, num_partners + 1),
      KOKKOS_LAMBDA(const std::int64_t partner) {
        const auto first_key = static_cast<std::uint64_t>(partner * num_rows);
        std::int64_t low = 0, high = num_pairs; // first key not below first_key
        while (low < high) {
          const std::int64_t middle = (low + high) / 2;
          if (sorted(middle) < first_key)
            low = middle + 1;
          else
            high = middle;
        }
        starts(partner) = low;
      });
  const Region copies("search::host-device copies");
  copyToHost(space, search.starts, num_partners + 1, lists.offsets);
}

// Rows whose box meets the box of a partner's rank; boxes_of_ranks are Bbar of the other kind.
void findCandidates(const exec_space& space, const View<const Box*>& boxes, int num_rows,
                    const std::vector<Box>& boxes_of_ranks, SearchMethod method,
                    RankBoxSearch& search, PartnerLists& lists) {
  lists.offsets.assign(lists.ranks.size() + 1, 0);
  if (lists.ranks.empty())
    return;
  search.host_boxes.clear();
  Box all;
  for (const int q : lists.ranks) {
    search.host_boxes.push_back(boxes_of_ranks[q]);
    all.include(boxes_of_ranks[q]);
  }
  if (method == SearchMethod::reference)
    return referenceCandidates(space, boxes, num_rows, search.host_boxes, lists);
  {
    const Region copies("search::host-device copies");
    copyToDevice(space, search.host_boxes, search.rank_boxes);
  }
  buildTree(space, search.rank_boxes, static_cast<int>(lists.ranks.size()), all, search.tree);
  const OverlapsRankBox accept{boxes, search.rank_boxes};
  queryTree(space, "contact::ghostingCandidates::query", search.tree, num_rows, BoxOfRow{boxes},
            accept, nullptr, search.results); // the large set is not sorted (paper, section 5)
  listByPartner(space, num_rows, search, lists);
}

} // namespace

void findPartnersAndCandidates(const exec_space& space, const Surface& surface,
                               const SurfaceBoxes& boxes, const RankBoxes& rank_boxes,
                               SearchMethod method, GhostingCandidates& candidates) {
  const Region region("findPartnersAndCandidates");
  auto& nodes = candidates.nodes_to_send;
  auto& faces = candidates.faces_to_test;
  {
    const Region timer("search::partners");
    findPartners(boxes.node_box, rank_boxes.face_boxes, rank_boxes.rank, nodes.ranks);
    findPartners(boxes.face_box, rank_boxes.node_boxes, rank_boxes.rank, faces.ranks);
  }
  const Region timer("search::searches 0 and 1");
  findCandidates(space, boxes.node_boxes, surface.num_nodes, rank_boxes.face_boxes, method,
                 candidates.node_search, nodes);
  findCandidates(space, boxes.face_boxes, surface.num_faces, rank_boxes.node_boxes, method,
                 candidates.face_search, faces);
}

} // namespace brickwall::contact
