// A cluster of neighbouring nodes walks a tree of boxes once for all of them: the point-wise part of the cluster search.
#pragma once

#include "contact/base/lanes.hpp"
#include "contact/box_tree.hpp"

namespace brickwall::contact {

// What the boxes of a cluster's nodes reach: a box overlaps one of them if none of its sides (FloatBounds) exceeds the
// node's reach, upper xyz, then minus lower xyz. Lanes without a node reach nothing.
struct NodeCluster {
  float lanes[6 * cluster_size]; // [side][lane]
  float all[6]; // the most of all lanes

  // From `bounds` [node position][6]; only lanes of `wanted` take part.
  KOKKOS_INLINE_FUNCTION void load(const float* bounds, unsigned wanted) {
    for (int s = 0; s < 6; ++s)
      all[s] = -HUGE_VALF;
    for (int lane = 0; lane < cluster_size; ++lane)
      for (int s = 0; s < 6; ++s) {
        const float reach = wanted >> lane & 1u ? -bounds[lane * 6 + (s + 3) % 6] : -HUGE_VALF;
        lanes[s * cluster_size + lane] = reach;
        all[s] = maxOf(all[s], reach);
      }
  }
};

KOKKOS_INLINE_FUNCTION void prefetchBlock(const float* block) {
  for (int line = 0; line < block_floats; line += 16)
    prefetch(block + line);
}

// Calls visit(block) for each block of level 0 whose box is within `reach`, in ascending order. Depth first; per level one
// block and the lanes of it that are still to be entered.
template <class Visit>
KOKKOS_INLINE_FUNCTION void walkTree(const BoxTree& tree, const float (&reach)[6],
                                     const Visit& visit) {
  int level = tree.num_levels - 1;
  if (level < 1) {
    if (level == 0)
      visit(0);
    return;
  }
  const int top = level;
  int block[most_levels];
  unsigned lanes[most_levels];
  const auto enter = [&](int child) {
    block[level] = child;
    lanes[level] = lanesWithin<block_size>(tree.block(level, child), reach);
    if (level == 1)
      for (unsigned wanted = lanes[1]; wanted != 0; wanted &= wanted - 1)
        prefetchBlock(tree.block(0, std::int64_t(child) * block_size + lowestBit(wanted)));
  };
  enter(0);
  while (true) {
    while (lanes[level] == 0)
      if (++level > top)
        return;
    const int child = block[level] * block_size + lowestBit(lanes[level]);
    lanes[level] &= lanes[level] - 1;
    if (level == 1) {
      visit(child);
    } else {
      --level;
      enter(child);
    }
  }
}

} // namespace brickwall::contact
