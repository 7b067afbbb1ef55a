// Stable least-significant-digit radix sort of 64-bit keys with an int payload, parallel over
// chunks, with the same result on all back ends (Kokkos 3.4 has no sort by key).
#pragma once

#include "contact/base/backend.hpp"

namespace brickwall::contact {

// Keys with their payload, and the scratch of the sort. The Views grow and never shrink.
struct SortedKeys {
  View<std::uint64_t*> keys{"contact::SortedKeys::keys", 0};
  View<int*> values{"contact::SortedKeys::values", 0};

  void grow(const exec_space& space, std::int64_t n);

  View<std::uint64_t*> other_keys{"contact::SortedKeys::other_keys", 0};
  View<int*> other_values{"contact::SortedKeys::other_values", 0};
  View<int*> counts{"contact::SortedKeys::counts", 0}; // [chunk][digit]
};

// Sorts rows [0, n) of sorted.keys and .values in place by the low `num_bits` bits of the keys
// (higher bits must be 0); equal keys keep their order. n < 2^31. The cost is proportional to n *
// num_bits.
void sortByKey(const exec_space& space, std::int64_t n, int num_bits, SortedKeys& sorted);

// Bits needed for keys in [0, limit).
int bitsFor(std::uint64_t limit);

} // namespace brickwall::contact
