// Results of variable length: count per item, exclusive scan with 64-bit offsets, fill.
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

template <class T, class Emit>
struct CountEmitted {
  Emit emit;
  View<std::int64_t*> counts;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t i) const {
    std::int64_t count = 0;
    emit(i, [&](const T&) { ++count; });
    counts(i) = count;
  }
};
template <class T, class Emit>
struct StoreEmitted {
  Emit emit;
  View<const std::int64_t*> offsets;
  View<T*> values;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t i) const {
    std::int64_t next = offsets(i);
    if (offsets(i + 1) > next)
      emit(i, [&](const T& value) { values(next++) = value; });
  }
};

// Calls emit(i, sink) for each i in [0, n) twice: in the first call sink(value) only counts, in the
// second, which is omitted for i that emitted nothing, it stores. On return offsets[0, n] are the
// exclusive offsets and values[offsets(i), offsets(i+1)) the values emitted by i, in order. Both
// Views grow and never shrink. Returns the total.
template <class T, class Emit>
std::int64_t countScanFill(const exec_space& space, const std::string& label, std::int64_t n,
                           const Emit& emit, View<std::int64_t*>& offsets, View<T*>& values) {
  growTo(space, offsets, n + 1);
  Kokkos::parallel_for(label + "::count", rangePolicy(space, n),
                       CountEmitted<T, Emit>{emit, offsets});
  launchScan(space, label + "::scan", offsets, n, offsets);
  std::int64_t total = 0;
  Kokkos::deep_copy(space, total, Kokkos::subview(offsets, static_cast<std::size_t>(n)));
  space.fence();
  growTo(space, values, total);
  Kokkos::parallel_for(label + "::fill", rangePolicy(space, n),
                       StoreEmitted<T, Emit>{emit, offsets, values});
  return total;
}

} // namespace brickwall
