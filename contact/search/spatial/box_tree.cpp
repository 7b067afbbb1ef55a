#include "contact/search/spatial/box_tree.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"

#include <algorithm>

namespace brickwall::contact {
namespace {

// The levels of a tree of n items, blocks counted from 0; `blocks` is not set.
BoxTree shapeOf(std::int64_t n) {
  BoxTree tree;
  tree.num_items = checkedInt(n, "boxes of a tree");
  std::int64_t blocks = 0;
  for (std::int64_t items = n; items > 0; ++tree.num_levels) {
    const std::int64_t of_level = dividedUp<std::int64_t>(items, block_size);
    tree.level_begin[tree.num_levels] = blocks;
    blocks += of_level;
    items = of_level > 1 ? of_level : 0;
  }
  for (int level = tree.num_levels; level <= max_levels; ++level)
    tree.level_begin[level] = blocks;
  return tree;
}

// Computes the levels of a tree from one on that has few lanes, in one team.
struct RefitSmallLevels {
  // A launch for each level takes longer than a team for all of them, which must be small to find
  // room beside other kernels. Hosts have no such launches.
  static constexpr std::int64_t most_lanes = fills_lanes ? 0 : 512;
  static constexpr int team_size = host_accessible ? 1 : 64;
  using Policy =
      Kokkos::TeamPolicy<exec_space, Kokkos::LaunchBounds<team_size, 1>, launch_by_argument>;

  View<const BoxTree*> trees;
  int first_level;

  KOKKOS_INLINE_FUNCTION void operator()(const Policy::member_type& team) const {
    refitLevels(team, trees(team.league_rank()), first_level);
  }
};

} // namespace

void BoxForest::shape(const exec_space& space, const std::vector<std::int64_t>& num_items) {
  if (num_items == _shape && num_items.size() == _trees.size())
    return;
  _shape = num_items;
  _trees.clear();
  std::int64_t blocks = 0;
  for (const std::int64_t n : num_items) {
    _trees.push_back(shapeOf(n));
    blocks += _trees.back().level_begin[max_levels];
  }
  growTo(space, _blocks, blocks * block_floats);
  float* next = _blocks.data();
  for (BoxTree& tree : _trees) {
    tree.blocks = next;
    next += tree.level_begin[max_levels] * block_floats;
  }
  copyToDevice(space, _trees, _device_trees);
}

void BoxForest::refitUpperLevels(const exec_space& space, int first_level) {
  int most = 0;
  for (const BoxTree& tree : _trees)
    most = std::max(most, tree.num_levels);
  for (int level = first_level; level < most; ++level) {
    std::int64_t lanes = 0; // most of one tree
    for (const BoxTree& tree : _trees)
      lanes = std::max(lanes, tree.numBlocks(level) * std::int64_t(block_size));
    const auto trees = _device_trees;
    if (lanes <= RefitSmallLevels::most_lanes) {
      Kokkos::parallel_for("contact::BoxForest::refit_small_levels",
                           RefitSmallLevels::Policy(space, numTrees(), RefitSmallLevels::team_size),
                           RefitSmallLevels{trees, level});
      return;
    }
    Kokkos::parallel_for(
        "contact::BoxForest::refit", rangePolicy(space, numTrees() * lanes),
        KOKKOS_LAMBDA(const std::int64_t i) {
          const BoxTree& tree = trees(i / lanes);
          const std::int64_t block = i % lanes / block_size;
          if (block < tree.numBlocks(level))
            refitLane(tree, level, block, static_cast<int>(i % block_size));
        });
  }
}

} // namespace brickwall::contact
