#include "contact/search/paper/ghosting_candidates.hpp"

#include "contact/base/region.hpp"

namespace brickwall::contact {
namespace {

struct OverlapsRankBox {
  View<const Box*> boxes;
  View<const Box*> rank_boxes;
  KOKKOS_INLINE_FUNCTION OverlapsRow operator()(int row) const {
    return {boxes(row), rank_boxes.data()};
  }
};

// Turns results by row into lists by partner, by sorting a key (partner, row) for each result.
void listByPartner(const exec_space& space, std::int64_t num_rows, RankBoxSearch& search,
                   PartnerLists& lists) {
  const auto num_partners = static_cast<std::int64_t>(lists.ranks.size());
  const std::int64_t num_pairs = search.results.num_rows;
  search.pairs.grow(space, num_pairs);
  const auto keys = search.pairs.keys;
  const auto begin = search.results.begin, count = search.results.count;
  const auto partners = search.results.items;
  Kokkos::parallel_for(
      "contact::findGhostingCandidates::keys", rangePolicy(space, num_rows),
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
      "contact::findGhostingCandidates::rows", rangePolicy(space, num_pairs),
      KOKKOS_LAMBDA(const std::int64_t i) {
        rows(i) = static_cast<int>(sorted(i) % static_cast<std::uint64_t>(num_rows));
      });
  Kokkos::parallel_for(
      "contact::findGhostingCandidates::starts", rangePolicy(space, num_partners + 1),
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
  const Region copies("contact::search::host_device_copies");
  copyToHost(space, search.starts, num_partners + 1, lists.offsets);
}

} // namespace

void findGhostingCandidates(const exec_space& space, const View<const Box*>& boxes, int num_rows,
                            const std::vector<Box>& rank_boxes, RankBoxSearch& search,
                            PartnerLists& lists) {
  Box all;
  for (const Box& box : rank_boxes)
    all.include(box);
  {
    const Region copies("contact::search::host_device_copies");
    copyToDevice(space, rank_boxes, search.rank_boxes);
  }
  buildTree(space, search.rank_boxes, static_cast<int>(rank_boxes.size()), all, search.tree);
  const OverlapsRankBox accept{boxes, search.rank_boxes};
  queryTree(space, "contact::findGhostingCandidates::query", search.tree, num_rows, BoxOfRow{boxes},
            accept, nullptr, search.results); // the large set is not sorted (paper, section 5)
  listByPartner(space, num_rows, search, lists);
}

} // namespace brickwall::contact
