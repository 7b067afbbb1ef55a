// Which blocks of rows of candidates sleep (sleeping_blocks.hpp), and by what bounds. For kernels.
#pragma once

#include "contact/enforcement/dormancy/separation.hpp"

namespace brickwall::contact {

constexpr int max_bounds = 6; // pairs of bodies in a block; blocks with more do not sleep

// For kernels: one entry a block.
struct SleepState {
  static constexpr unsigned char awake = 255;

  View<unsigned char*> num_bounds; // `awake`, or the number of bounds that it sleeps by
  // First bounds of all blocks, then the second ones, and so on: few blocks have many.
  View<KeptBound*> bounds;
  // Blocks whose bounds cannot be found, or are soon used up, are left alone for some steps: twice as many from time to time.
  View<unsigned char*> age, wait, patience;

  KOKKOS_INLINE_FUNCTION KeptBound& bound(std::int64_t block, int b) const {
    return bounds(b * static_cast<std::int64_t>(num_bounds.extent(0)) + block);
  }
  KOKKOS_INLINE_FUNCTION bool sleeps(std::int64_t block) const {
    return num_bounds(block) != awake;
  }
  KOKKOS_INLINE_FUNCTION void leaveAlone(std::int64_t block) const {
    constexpr int longest = 31;
    const int now = patience(block);
    wait(block) = patience(block) = static_cast<unsigned char>(minOf(2 * now + 1, longest));
  }
};

} // namespace brickwall::contact
