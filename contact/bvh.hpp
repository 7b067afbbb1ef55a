// Bounding volume hierarchy (paper, section 5): the binary radix tree of Karras (2012) over Morton-sorted boxes, all
// inner nodes in parallel, their boxes bottom-up. Inner bounds are floats rounded outward: no overlap is ever lost;
// leaves are tested in double by the query.
#pragma once

#include "contact/morton.hpp"
#include "contact/radix_sort.hpp"

#include <cstring>

namespace brickwall::contact {

// Steps to the next float in the order of bit patterns; `value` is finite or infinite, not NaN.
KOKKOS_INLINE_FUNCTION float nextFloat(float value, bool up) {
  std::int32_t bits;
  memcpy(&bits, &value, sizeof bits);
  if ((bits & 0x7fffffff) == 0)
    bits = up ? 1 : std::int32_t(0x80000001); // smallest magnitude of that sign
  else
    bits += (bits > 0) == up ? 1 : -1;
  memcpy(&value, &bits, sizeof value);
  return value;
}
// Largest float <= value, smallest float >= value.
KOKKOS_INLINE_FUNCTION float floatBelow(double value) {
  const float nearest = static_cast<float>(value);
  return static_cast<double>(nearest) > value ? nextFloat(nearest, false) : nearest;
}
KOKKOS_INLINE_FUNCTION float floatAbove(double value) {
  const float nearest = static_cast<float>(value);
  return static_cast<double>(nearest) < value ? nextFloat(nearest, true) : nearest;
}

// A box of floats that holds a box of doubles.
struct FloatBox {
  float lower[3];
  float upper[3];

  FloatBox() = default;
  KOKKOS_INLINE_FUNCTION explicit FloatBox(const Box& box) {
    for (int d = 0; d < 3; ++d) {
      lower[d] = floatBelow(box.lower[d]);
      upper[d] = floatAbove(box.upper[d]);
    }
  }
  KOKKOS_INLINE_FUNCTION void include(const FloatBox& b) {
    for (int d = 0; d < 3; ++d) {
      lower[d] = minOf(lower[d], b.lower[d]);
      upper[d] = maxOf(upper[d], b.upper[d]);
    }
  }
  // Closed; no branches, since either answer is likely.
  KOKKOS_INLINE_FUNCTION bool overlaps(const FloatBox& b) const {
    return (lower[0] <= b.upper[0]) & (b.lower[0] <= upper[0]) & (lower[1] <= b.upper[1]) &
           (b.lower[1] <= upper[1]) & (lower[2] <= b.upper[2]) & (b.lower[2] <= upper[2]);
  }
};

// An inner node with its children's boxes: one cache line answers which way a query goes.
struct TreeNode {
  FloatBox box[2];
  int child[2]; // inner node, or ~item of a leaf
  int parent; // 2 * inner node + side; -1 at the root
};

// Deepest path: one level for each bit of a code and, among equal codes, of an index.
constexpr int max_tree_depth = morton_bits + 32;

struct Bvh {
  int num_items = 0; // leaves
  View<TreeNode*> nodes{"contact::Bvh::nodes", 0}; // max(num_items - 1, 1) inner nodes, root first
  View<int*> visits{"contact::Bvh::visits", 0}; // [inner node] children whose box is known
  View<int*> leaf_parent{"contact::Bvh::leaves", 0}; // [sorted leaf] as TreeNode::parent
  SortedKeys order; // Morton codes and items
};

// Builds the tree over items[0, num_items); `all` holds their centroids (codes are relative to it). Items of equal
// code are told apart by their index.
void buildTree(const exec_space& space, const View<const Box*>& items, int num_items,
               const Box& all, Bvh& tree);

} // namespace brickwall::contact
