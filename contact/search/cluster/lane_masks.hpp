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

// The number of bits of each mask, for launchScan().
struct CountMasked {
  View<const unsigned*> masks;

  KOKKOS_INLINE_FUNCTION int operator()(const std::int64_t i) const { return countBits(masks(i)); }
};

} // namespace brickwall::contact
