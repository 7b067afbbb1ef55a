// Packet traversal of a tree of boxes by a cluster of neighbouring nodes: the point-wise part of
// the cluster search.
#pragma once

#include "contact/search/spatial/tree_walk.hpp"

namespace brickwall::contact {

// The reach of the node boxes of a cluster: a box overlaps a node box if none of its sides
// (FloatBounds) exceeds the node's reach, upper xyz, then minus lower xyz. Lanes without a node
// reach nothing.
struct NodeCluster {
  float lanes[6 * cluster_size]; // [side][lane]
  FloatBounds all; // the maximum of all lanes

  // Takes the lanes in `used` from `bounds` [node position][6]; `of_used` is the union of their
  // bounds.
  KOKKOS_INLINE_FUNCTION void load(const float* bounds, const float* of_used, unsigned used) {
    reachOfRows<cluster_size>(bounds, lanes);
    for (int s = 0; s < 6; ++s)
      all.side[s] = -of_used[(s + 3) % 6];
    if (used != all_lanes)
      for (int lane = 0; lane < cluster_size; ++lane)
        for (int s = 0; s < 6; ++s)
          if (!(used >> lane & 1u))
            lanes[s * cluster_size + lane] = -HUGE_VALF;
  }

private:
  static constexpr unsigned all_lanes = (1u << cluster_size) - 1;
};

// Calls visit(block) for each block of level 0 whose box overlaps the union of the cluster's boxes,
// in ascending order.
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
