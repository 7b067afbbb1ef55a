// A cluster of neighbouring nodes walks a tree of boxes once for all of them: the point-wise part of the cluster search.
#pragma once

#include "contact/base/lanes.hpp"
#include "contact/box_tree.hpp"

namespace brickwall::contact {

// Boxes of a cluster's nodes, side by side, and what their union reaches. Lanes without a node hold the empty box.
struct NodeCluster {
  float sides[6 * cluster_size]; // [side][lane]
  float reach[6]; // FloatBounds::reach() of the union

  // From `bounds` [node position][6]; only lanes of `wanted` take part.
  KOKKOS_INLINE_FUNCTION void load(const float* bounds, unsigned wanted) {
    FloatBounds all;
    for (int lane = 0; lane < cluster_size; ++lane)
      for (int s = 0; s < 6; ++s) {
        const float side = wanted >> lane & 1u ? bounds[lane * 6 + s] : HUGE_VALF;
        sides[s * cluster_size + lane] = side;
        all.side[s] = minOf(all.side[s], side);
      }
    const FloatBounds of_union = all.reach();
    for (int s = 0; s < 6; ++s)
      reach[s] = of_union.side[s];
  }
};

// What a box must be within to overlap the box of lane `lane` of a block.
KOKKOS_INLINE_FUNCTION void reachOfLane(const float* block, int lane, float (&reach)[6]) {
  for (int d = 0; d < 3; ++d) {
    reach[d] = -block[(3 + d) * block_size + lane];
    reach[3 + d] = -block[d * block_size + lane];
  }
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
  block[top] = 0;
  lanes[top] = lanesWithin<block_size>(tree.block(top, 0), reach);
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
      block[level] = child;
      lanes[level] = lanesWithin<block_size>(tree.block(level, child), reach);
    }
  }
}

} // namespace brickwall::contact
