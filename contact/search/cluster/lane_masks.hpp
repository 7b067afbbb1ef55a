// Results of tests in groups of up to 32, as bits of a word for each group. On a host a thread
// tests a group, on a device several threads share it.
#pragma once

#include "contact/base/lanes.hpp"

namespace brickwall::contact {

// To be called before storeMask() of these masks.
template <int threads_per_group>
void clearMasks(const exec_space& space, const View<unsigned*>& masks) {
  if (threads_per_group > 1)
    Kokkos::deep_copy(space, masks, 0u);
}

// Stores the bits that one of the threads of a group has found.
template <int threads_per_group>
KOKKOS_INLINE_FUNCTION void storeMask(unsigned& mask, unsigned bits) {
  if (threads_per_group == 1)
    mask = bits;
  else if (bits != 0)
    Kokkos::atomic_fetch_or(&mask, bits);
}

// Scan over n + 1 entries: offsets(i) is the number of bits of the masks before i.
struct ScanMasks {
  View<const unsigned*> masks;
  View<std::int64_t*> offsets;
  std::int64_t n;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t i, std::int64_t& sum,
                                         const bool final) const {
    if (final)
      offsets(i) = sum;
    if (i < n)
      sum += countBits(masks(i));
  }
};

} // namespace brickwall::contact
