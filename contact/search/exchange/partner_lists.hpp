// Lists of local rows by partner rank: the form of L_gns, L_gfs and L_ges (paper, section 4).
#pragma once

#include "contact/base/backend.hpp"
#include "contact/base/region.hpp"
#include "contact/base/to_device.hpp"

#include <vector>

namespace brickwall::contact {

struct PartnerLists {
  std::vector<int> ranks; // partners, ascending
  std::vector<std::int64_t> offsets{0}; // [partner + 1] into rows
  // By partner, within one in an order that depends on the method; the View may be longer.
  View<int*> rows{"contact::PartnerLists::rows", 0};

  std::int64_t size() const { return offsets.back(); }
};

// The partner whose rows [offsets(p), offsets(p + 1)) hold row i.
KOKKOS_INLINE_FUNCTION int partnerOf(const View<const std::int64_t*>& offsets, int num_partners,
                                     std::int64_t i) {
  int low = 0, high = num_partners; // the last partner whose first row is not after i
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    if (offsets(middle) <= i)
      low = middle;
    else
      high = middle;
  }
  return low;
}

// Copies the first `n` entries of a device View to the host vector. Fences.
template <class T>
void copyToHost(const exec_space& space, const View<T*>& from, std::int64_t n, std::vector<T>& to) {
  to.resize(static_cast<std::size_t>(n));
  if (n > 0)
    Kokkos::deep_copy(
        space, Kokkos::View<T*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged>(to.data(), to.size()),
        Kokkos::subview(from, std::make_pair(std::size_t(0), static_cast<std::size_t>(n))));
  space.fence();
}

struct TakePositions {
  View<const std::int64_t*> positions;
  View<std::int64_t*> starts;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t partner) const {
    starts(partner) = positions(starts(partner));
  }
};

// Sets kept.offsets where only some entries of a list were kept. `starts` [partner + 1] are the
// offsets of all entries, positions(entry) is the number of entries kept before this one. Fences.
inline void offsetsOfKept(const exec_space& space, const View<const std::int64_t*>& positions,
                          const View<std::int64_t*>& starts, PartnerLists& kept) {
  const auto num_partners = static_cast<std::int64_t>(kept.ranks.size());
  Kokkos::parallel_for("contact::offsetsOfKept", rangePolicy(space, num_partners + 1),
                       TakePositions{positions, starts});
  const Region copies("contact::search::host_device_copies");
  copyToHost(space, starts, num_partners + 1, kept.offsets);
}

} // namespace brickwall::contact
