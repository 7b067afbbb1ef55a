// A bounding volume hierarchy without pointers for items that are already sorted along a space
// filling curve: blocks of eight boxes, the eight children of a node side by side, level above
// level. It is built by refitting alone: no sort, no atomics, no topology.
// Equations: theory.md, section 3.
#pragma once

#include "contact/search/spatial/float_bounds.hpp"

#include <vector>

namespace brickwall::contact {

constexpr int block_size = 8; // items of a block, children of a node
constexpr int max_levels = 11; // 8^11 > 2^31 items

// Floats of a block [side][lane]: the same side of eight boxes is contiguous. Unused lanes hold the
// empty box.
constexpr int block_floats = 6 * block_size;

// A tree as used in kernels. Level 0 holds the items: item i is lane i % 8 of block i / 8. Box b of
// level l + 1 is the union of block b of level l. The top level has one block. A tree without items
// has no level.
struct BoxTree {
  float* blocks = nullptr; // [block][side][lane], all levels
  int num_items = 0;
  int num_levels = 0;
  std::int64_t level_begin[max_levels + 1] = {}; // first block of each level, from `blocks`

  KOKKOS_INLINE_FUNCTION float* block(int level, std::int64_t i) const {
    return blocks + (level_begin[level] + i) * block_floats;
  }
  KOKKOS_INLINE_FUNCTION int numBlocks(int level) const {
    return static_cast<int>(level_begin[level + 1] - level_begin[level]);
  }
};

// The union of a block's boxes.
KOKKOS_INLINE_FUNCTION FloatBounds unionOfBlock(const float* block) {
  FloatBounds all;
  for (int s = 0; s < 6; ++s)
    for (int lane = 0; lane < block_size; ++lane)
      all.side[s] = minOf(all.side[s], block[s * block_size + lane]);
  return all;
}
KOKKOS_INLINE_FUNCTION void storeLane(float* block, int lane, const FloatBounds& box) {
  for (int s = 0; s < 6; ++s)
    block[s * block_size + lane] = box.side[s];
}

// Computes the box of lane `lane` of block `i` of an upper level.
KOKKOS_INLINE_FUNCTION void refitLane(const BoxTree& tree, int level, std::int64_t i, int lane) {
  const std::int64_t child = i * block_size + lane;
  storeLane(tree.block(level, i), lane,
            child < tree.numBlocks(level - 1) ? unionOfBlock(tree.block(level - 1, child))
                                              : FloatBounds());
}

// Computes the boxes of the levels from `first_level` up, by one team.
template <class Member>
KOKKOS_INLINE_FUNCTION void refitLevels(const Member& team, const BoxTree& tree, int first_level) {
  for (int level = first_level; level < tree.num_levels; ++level) {
    Kokkos::parallel_for(
        Kokkos::TeamThreadRange(team, tree.numBlocks(level) * block_size),
        [&](const int i) { refitLane(tree, level, i / block_size, i % block_size); });
    team.team_barrier();
  }
}

// One or several trees in one allocation, such as one for each sender of node boxes.
class BoxForest {
public:
  // Lays out trees of these numbers of items; allocates only to grow. The contents are undefined
  // until level 0 is filled and refitUpperLevels() is called.
  void shape(const exec_space& space, const std::vector<std::int64_t>& num_items);
  void shape(const exec_space& space, std::int64_t num_items) { // a single tree
    if (_shape.size() != 1 || _shape[0] != num_items)
      shape(space, std::vector<std::int64_t>{num_items});
  }

  // Computes the boxes of the levels from `first_level` up; the levels below must be filled.
  void refitUpperLevels(const exec_space& space, int first_level = 1);

  int numTrees() const { return static_cast<int>(_trees.size()); }
  // To be captured by value.
  const BoxTree& tree(int t) const { return _trees[static_cast<std::size_t>(t)]; }
  const View<BoxTree*>& deviceTrees() const { return _device_trees; } // [tree]

private:
  std::vector<BoxTree> _trees;
  std::vector<std::int64_t> _shape; // of the last shape()
  View<BoxTree*> _device_trees{"contact::BoxForest::trees", 0};
  View<float*> _blocks{"contact::BoxForest::blocks", 0};
};

} // namespace brickwall::contact
