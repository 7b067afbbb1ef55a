#include "contact/search/paper/face_ghost_search.hpp"

#include "contact/base/scan.hpp"

namespace brickwall::contact {
namespace {

struct FaceOverlapsNode {
  View<const Box*> face_boxes;
  View<const int*> faces; // L_gfs, all partners
  View<const Box*> node_boxes;
  KOKKOS_INLINE_FUNCTION OverlapsRow operator()(int entry) const {
    return {face_boxes(faces(entry)), node_boxes.data()};
  }
};

// positions(entry) = 1 if the entry overlaps a node box of its own partner, otherwise 0.
void flagEntries(const exec_space& space, const PartnerLists& faces_to_test,
                 const RemoteNodeBoxes& remote, FaceGhostSearch& search) {
  const auto begin = search.results.begin, count = search.results.count;
  const auto nodes = search.results.items;
  const auto positions = search.positions;
  const View<const int*> senders = remote.senders;
  const View<const std::int64_t*> starts = search.starts;
  const auto num_partners = static_cast<int>(faces_to_test.ranks.size());
  Kokkos::parallel_for(
      "contact::findFacesToSend::filter", rangePolicy(space, faces_to_test.size()),
      KOKKOS_LAMBDA(const std::int64_t entry) {
        const int partner = partnerOf(starts, num_partners, entry);
        std::int64_t flag = 0;
        for (std::int64_t i = begin(entry); i < begin(entry) + count(entry) && flag == 0; ++i)
          flag = senders(nodes(i)) == partner ? 1 : 0;
        positions(entry) = flag;
      });
}

// Keeps the flagged entries, in their order.
void compactEntries(const exec_space& space, const PartnerLists& faces_to_test,
                    FaceGhostSearch& search, PartnerLists& faces_to_send) {
  const std::int64_t num_entries = faces_to_test.size();
  const auto positions = search.positions;
  const std::int64_t num_kept =
      scanCounts(space, "contact::findFacesToSend::scan", positions, num_entries);
  growTo(space, faces_to_send.rows, num_kept);
  const View<const int*> faces = faces_to_test.rows;
  const auto kept = faces_to_send.rows;
  Kokkos::parallel_for(
      "contact::findFacesToSend::compact", rangePolicy(space, num_entries),
      KOKKOS_LAMBDA(const std::int64_t entry) {
        if (positions(entry + 1) > positions(entry))
          kept(positions(entry)) = faces(entry);
      });
  offsetsOfKept(space, positions, search.starts, faces_to_send);
}

// Number of rows whose successor, of the same partner, has a smaller face id.
std::int64_t countDescents(const exec_space& space, const View<const global_id*>& ids,
                           const PartnerLists& lists, FaceGhostSearch& search) {
  copyToDevice(space, lists.offsets, search.starts);
  const View<const std::int64_t*> starts = search.starts;
  const View<const int*> faces = lists.rows;
  const auto num_partners = static_cast<int>(lists.ranks.size());
  std::int64_t descents = 0;
  Kokkos::parallel_reduce(
      "contact::orderByFaceId::descents",
      rangePolicy(space, maxOf(lists.size() - 1, std::int64_t(0))),
      KOKKOS_LAMBDA(const std::int64_t i, std::int64_t& sum) {
        if (ids(faces(i)) > ids(faces(i + 1)) &&
            partnerOf(starts, num_partners, i) == partnerOf(starts, num_partners, i + 1))
          ++sum;
      },
      descents);
  return descents;
}

} // namespace

std::int64_t findFacesToSend(const exec_space& space, const View<const Box*>& face_boxes,
                             const PartnerLists& faces_to_test, const RemoteNodeBoxes& remote,
                             FaceGhostSearch& search, PartnerLists& faces_to_send) {
  const auto num_entries = static_cast<int>(faces_to_test.size());
  buildTree(space, remote.boxes, static_cast<int>(remote.size()), remote.all, search.tree);
  const BoxOfListed box_of{face_boxes, faces_to_test.rows};
  const bool sorted = worthSorting(num_entries, remote.size());
  if (sorted)
    sortQueries(space, box_of, num_entries, remote.all, search.order);
  const std::int64_t num_pairs =
      queryTree(space, "contact::findFacesToSend::query", search.tree, num_entries, box_of,
                FaceOverlapsNode{face_boxes, faces_to_test.rows, remote.boxes},
                sorted ? &search.order : nullptr, search.results);
  growTo(space, search.positions, num_entries + 1);
  copyToDevice(space, faces_to_test.offsets, search.starts);
  flagEntries(space, faces_to_test, remote, search);
  compactEntries(space, faces_to_test, search, faces_to_send);
  return num_pairs;
}

void orderByFaceId(const exec_space& space, const View<const global_id*>& ids,
                   FaceGhostSearch& search, PartnerLists& lists) {
  if (countDescents(space, ids, lists, search) == 0)
    return;
  const auto faces = lists.rows;
  for (std::size_t p = 0; p < lists.ranks.size(); ++p) {
    const std::int64_t first = lists.offsets[p], n = lists.offsets[p + 1] - first;
    search.by_id.grow(space, n);
    const auto keys = search.by_id.keys;
    const auto values = search.by_id.values;
    Kokkos::parallel_for(
        "contact::orderByFaceId::keys", rangePolicy(space, n), KOKKOS_LAMBDA(const std::int64_t i) {
          keys(i) = static_cast<std::uint64_t>(ids(faces(first + i)));
          values(i) = faces(first + i);
        });
    sortByKey(space, n, 63, search.by_id);
    const auto sorted = search.by_id.values;
    Kokkos::parallel_for(
        "contact::orderByFaceId::copy", rangePolicy(space, n),
        KOKKOS_LAMBDA(const std::int64_t i) { faces(first + i) = sorted(i); });
  }
}

} // namespace brickwall::contact
