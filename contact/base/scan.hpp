// Exclusive scans for results of variable length: offsets from counts, and lists of flagged rows.
#pragma once

#include "contact/base/backend.hpp"

namespace brickwall {

template <class Count>
struct ScanCounts {
  Count count;
  View<std::int64_t*> offsets;
  std::int64_t n;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t i, std::int64_t& sum,
                                         const bool final) const {
    const std::int64_t number = i < n ? count(i) : 0;
    if (final)
      offsets(i) = sum;
    sum += number;
  }
};

// Sets offsets(i), i of [0, n], to the sum of count(k) for k < i; `count` may be `offsets` itself.
template <class Count>
void launchScan(const exec_space& space, const std::string& label, const Count& count,
                std::int64_t n, const View<std::int64_t*>& offsets) {
  Kokkos::parallel_scan(label, rangePolicy(space, n + 1), ScanCounts<Count>{count, offsets, n});
}

// Turns counts[0, n) into exclusive offsets in place, with offsets[n] the total, which is returned.
// `counts` has n + 1 entries or more. Fences (the total is read by the host).
inline std::int64_t scanCounts(const exec_space& space, const std::string& label,
                               const View<std::int64_t*>& counts, std::int64_t n) {
  std::int64_t total = 0;
  Kokkos::parallel_scan(label, rangePolicy(space, n + 1),
                        ScanCounts<View<std::int64_t*>>{counts, counts, n}, total);
  return total;
}

template <class Rows, class Count>
struct ListFlagged {
  View<const unsigned char*> flags;
  Rows rows;
  std::int64_t n;
  View<int*> listed;
  View<Count*> before;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t i, Count& sum, const bool final) const {
    const bool is_listed = i < n && flags(rows(i)) != 0;
    if (final) {
      before(i) = sum;
      if (is_listed)
        listed(sum) = static_cast<int>(rows(i));
    }
    sum += is_listed ? 1 : 0;
  }
};

// Lists those of rows(i), i of [0, n), whose flags [row] are set, in order; before(i) is how many
// of them precede rows(i), and before(n) their number.
template <class Rows, class Count>
void listFlagged(const exec_space& space, const std::string& label,
                 const View<const unsigned char*>& flags, const Rows& rows, std::int64_t n,
                 const View<int*>& listed, const View<Count*>& before) {
  Kokkos::parallel_scan(label, rangePolicy(space, n + 1),
                        ListFlagged<Rows, Count>{flags, rows, n, listed, before});
}

} // namespace brickwall
