// A cluster of neighbouring nodes walks a tree of boxes once for all of them: the point-wise part of the cluster search.
#pragma once

#include "contact/search/spatial/tree_walk.hpp"

namespace brickwall::contact {

// What the boxes of a cluster's nodes reach: a box overlaps one of them if none of its sides (FloatBounds) exceeds the
// node's reach, upper xyz, then minus lower xyz. Lanes without a node reach nothing.
struct NodeCluster {
  float lanes[6 * cluster_size]; // [side][lane]
  FloatBounds all; // the most of all lanes

  // From `bounds` [node position][6] and `of_wanted`, the union of those of the lanes in `wanted`, which alone take part.
  KOKKOS_INLINE_FUNCTION void load(const float* bounds, const float* of_wanted, unsigned wanted) {
    for (int s = 0; s < 6; ++s) {
      const float* const side = bounds + (s + 3) % 6;
      for (int lane = 0; lane < cluster_size; ++lane)
        lanes[s * cluster_size + lane] = -side[lane * 6];
      all.side[s] = -of_wanted[(s + 3) % 6];
    }
    if (wanted != all_lanes)
      for (int lane = 0; lane < cluster_size; ++lane)
        for (int s = 0; s < 6; ++s)
          if (!(wanted >> lane & 1u))
            lanes[s * cluster_size + lane] = -HUGE_VALF;
  }

private:
  static constexpr unsigned all_lanes = (1u << cluster_size) - 1;
};

// Calls visit(block) for each block of level 0 whose box overlaps the union of the cluster's boxes, in ascending order.
template <class Visit>
KOKKOS_INLINE_FUNCTION void walkBlocks(const BoxTree& tree, const FloatBounds& reach,
                                       const Visit& visit) {
  if (tree.num_levels > 1)
    walkLevels(tree, tree.num_levels - 1, 0, 1, reach, [&](const std::int64_t block) {
      visit(block);
      return true;
    });
  else if (tree.num_levels == 1)
    visit(std::int64_t(0));
}

} // namespace brickwall::contact
