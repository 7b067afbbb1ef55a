// Linear bounding volume hierarchy (LBVH; paper, section 5): the binary radix tree of Karras (2012)
// over Morton-sorted boxes. All inner nodes are built in parallel, their boxes bottom-up. Inner
// boxes are rounded to floats, which loses no overlap; the query tests leaves in double precision.
// Equations: theory.md, section 3.
#pragma once

#include "contact/search/spatial/float_bounds.hpp"
#include "contact/search/spatial/morton.hpp"
#include "contact/search/spatial/radix_sort.hpp"

#include <cstring>

namespace brickwall::contact {

// An inner node with the boxes of its children: a query reads one cache line per node.
struct TreeNode {
  float bounds[12]; // FloatBounds::side [k][side] of the children
  int child[2]; // inner node, or ~item of a leaf
  int parent; // 2 * inner node + side; -1 at the root
  int visits; // children whose box is known, while the tree is built

  KOKKOS_INLINE_FUNCTION void setBox(int side, const FloatBounds& box) {
    for (int k = 0; k < 6; ++k)
      bounds[2 * k + side] = box.side[k];
  }
  KOKKOS_INLINE_FUNCTION FloatBounds box(int side) const {
    FloatBounds box;
    for (int k = 0; k < 6; ++k)
      box.side[k] = bounds[2 * k + side];
    return box;
  }
};

// A query box as the limits that the bounds of overlapping boxes must not exceed.
struct FloatQuery {
  float limit[12]; // upper x, y, z, then -lower x, y, z; each twice, one for each child

  // Deliberately not inlined: limits in memory are loaded as vectors, whereas limits held in scalar
  // registers make the compiler drop the vector instructions of test(), which costs half as much
  // time again with g++ 12.
  KOKKOS_FUNCTION __attribute__((noinline)) explicit FloatQuery(const Box& box) {
    for (int d = 0; d < 3; ++d) {
      limit[2 * d] = limit[2 * d + 1] = toFloat(box.upper[d]);
      limit[6 + 2 * d] = limit[7 + 2 * d] = -toFloat(box.lower[d]);
    }
  }

  // Whether the query overlaps the boxes of the two children. The sign bits of differences are
  // joined in rows of four, which compilers translate to a few vector instructions. Limits are
  // finite, so no difference is NaN.
  KOKKOS_FORCEINLINE_FUNCTION void test(const TreeNode& node, bool (&overlaps)[2]) const {
    float room[12];
    for (int i = 0; i < 12; ++i)
      room[i] = limit[i] - node.bounds[i];
    std::uint32_t bits[12], row[4];
    memcpy(bits, room, sizeof bits);
    for (int i = 0; i < 4; ++i)
      row[i] = bits[i] | bits[4 + i] | bits[8 + i];
    std::uint64_t half[2]; // two rows at once
    memcpy(half, row, sizeof half);
    half[0] |= half[1];
    std::uint32_t apart[2];
    memcpy(apart, half, sizeof apart);
    overlaps[0] = apart[0] >> 31 == 0;
    overlaps[1] = apart[1] >> 31 == 0;
  }
};

// Deepest path: one level for each bit of a code and, among equal codes, of an index.
constexpr int max_tree_depth = morton_bits + 32;

struct Bvh {
  int num_items = 0; // leaves
  View<TreeNode*> nodes{"contact::Bvh::nodes", 0}; // max(num_items - 1, 1) inner nodes, root first
  View<int*> leaf_parent{"contact::Bvh::leaves", 0}; // [sorted leaf] as TreeNode::parent
  SortedKeys order; // Morton codes and items
};

// Builds the tree over items[0, num_items); `all` contains their centroids (codes are relative to
// it). Items of equal code are distinguished by their index.
void buildTree(const exec_space& space, const View<const Box*>& items, int num_items,
               const Box& all, Bvh& tree);

} // namespace brickwall::contact
