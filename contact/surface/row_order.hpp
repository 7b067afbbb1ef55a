// Sorting one row of candidates in a kernel.
#pragma once

#include "contact/base/backend.hpp"

namespace brickwall::contact {

// Sifts entry `root` of a heap of n entries (largest first) down.
template <class Before>
KOKKOS_INLINE_FUNCTION void siftDown(int* row, std::int64_t root, std::int64_t n,
                                     const Before& before) {
  for (std::int64_t child = 2 * root + 1; child < n; child = 2 * root + 1) {
    if (child + 1 < n && before(row[child], row[child + 1]))
      ++child;
    if (!before(row[root], row[child]))
      return;
    const int swapped = row[root];
    row[root] = row[child];
    row[child] = swapped;
    root = child;
  }
}

// Insertion sort for the usual short row, heap sort for a long one.
template <class Before>
KOKKOS_INLINE_FUNCTION void sortRow(int* row, std::int64_t n, const Before& before) {
  if (n <= 48) {
    for (std::int64_t i = 1; i < n; ++i) {
      const int face = row[i];
      std::int64_t to = i;
      for (; to > 0 && before(face, row[to - 1]); --to)
        row[to] = row[to - 1];
      row[to] = face;
    }
    return;
  }
  for (std::int64_t root = n / 2; root-- > 0;)
    siftDown(row, root, n, before);
  for (std::int64_t last = n - 1; last > 0; --last) {
    const int swapped = row[0];
    row[0] = row[last];
    row[last] = swapped;
    siftDown(row, 0, last, before);
  }
}

} // namespace brickwall::contact
