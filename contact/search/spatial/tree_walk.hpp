// Traversal of a tree of blocks of eight boxes with one box: depth first, in the order of the
// items, without recursion and with a few bytes of state per level.
// Equations: theory.md, section 3 (packet traversal).
#pragma once

#include "contact/base/lanes.hpp"
#include "contact/search/spatial/box_tree.hpp"

namespace brickwall::contact {

// The lanes of a block whose boxes overlap, in floats, the box of this reach, as bits; these
// include all that overlap in doubles. With Strict, lanes with a tie in floats are left out: the
// others overlap in doubles, too.
template <bool Strict = false>
KOKKOS_INLINE_FUNCTION unsigned lanesOverlapping(const float* block, const FloatBounds& reach) {
  return lanesWithin<Strict>(block, block_size, reach.side);
}

KOKKOS_FORCEINLINE_FUNCTION void prefetchBlock(const float* block) {
  constexpr int line = 16; // floats of a cache line
  for (int i = 0; i < block_floats; i += line)
    prefetch(block + i);
}

KOKKOS_INLINE_FUNCTION FloatBounds boundsOfLane(const float* block, int lane) {
  FloatBounds bounds;
  for (int s = 0; s < 6; ++s)
    bounds.side[s] = block[s * block_size + lane];
  return bounds;
}

// Calls visit(i) for the boxes i of level `last` below block `start` of level `first` >= `last`
// that overlap the box of this reach, in ascending order, as long as visit() returns true. Returns
// the number of blocks whose boxes were tested.
template <class Visit>
KOKKOS_INLINE_FUNCTION int walkLevels(const BoxTree& tree, int first, std::int64_t start, int last,
                                      const FloatBounds& reach, const Visit& visit) {
  std::int64_t block[max_levels]; // on the way down
  unsigned lanes[max_levels]; // still to be visited there
  int level = first, num_tested = 0;
  const auto enter = [&](std::int64_t child) {
    ++num_tested;
    block[level] = child;
    lanes[level] = lanesOverlapping(tree.block(level, child), reach);
    if (level == last && last > 0) // visit() will read these
      for (unsigned next = lanes[level]; next != 0; next &= next - 1)
        prefetchBlock(tree.block(last - 1, child * block_size + lowestBit(next)));
  };
  enter(start);
  while (true) {
    if (lanes[level] == 0) {
      if (++level > first)
        return num_tested;
      continue;
    }
    const std::int64_t box = block[level] * block_size + lowestBit(lanes[level]);
    lanes[level] &= lanes[level] - 1;
    if (level == last) {
      if (!visit(box))
        return num_tested;
    } else {
      --level;
      enter(box);
    }
  }
}

} // namespace brickwall::contact
