#include "contact/search/spatial/bvh.hpp"

namespace brickwall::contact {
namespace {

// The part of two keys that differs. Smaller leading bit = longer common prefix.
struct KeyDifference {
  morton_code code = ~morton_code(0);
  std::uint32_t index = ~std::uint32_t(0);
};

// True when the highest set bit of a is below that of b.
template <class Unsigned>
KOKKOS_INLINE_FUNCTION bool lowerLeadingBit(Unsigned a, Unsigned b) {
  return a < b && a < (a ^ b);
}
// Keys that differ by `a` share a longer prefix than keys that differ by `b`: delta(a) > delta(b)
// of Karras.
KOKKOS_INLINE_FUNCTION bool sharesMore(const KeyDifference& a, const KeyDifference& b) {
  if (a.code == 0 && b.code == 0)
    return lowerLeadingBit(a.index, b.index);
  return lowerLeadingBit(a.code, b.code);
}

// Sorted keys; rows outside [0, num_items) differ from all in the first bit.
struct Keys {
  View<const morton_code*> codes;
  int num_items;

  KOKKOS_INLINE_FUNCTION KeyDifference difference(int i, int j) const {
    KeyDifference d;
    if (j >= 0 && j < num_items) {
      d.code = codes(i) ^ codes(j);
      d.index = static_cast<std::uint32_t>(i) ^ static_cast<std::uint32_t>(j);
    }
    return d;
  }
};

struct Range {
  int first, split, last; // children cover [first, split] and [split + 1, last]
};

// Karras (2012), Fig. 4: the keys below inner node i.
KOKKOS_INLINE_FUNCTION Range rangeOfNode(const Keys& keys, int i) {
  const int direction = sharesMore(keys.difference(i, i + 1), keys.difference(i, i - 1)) ? 1 : -1;
  const KeyDifference outside = keys.difference(i, i - direction);
  std::int64_t limit = 2; // 64 bits: doubling may pass the last row
  while (i + limit * direction >= 0 && i + limit * direction < keys.num_items &&
         sharesMore(keys.difference(i, static_cast<int>(i + limit * direction)), outside))
    limit *= 2;
  std::int64_t length = 0;
  for (std::int64_t step = limit / 2; step >= 1; step /= 2) {
    const std::int64_t j = i + (length + step) * direction;
    if (j >= 0 && j < keys.num_items &&
        sharesMore(keys.difference(i, static_cast<int>(j)), outside))
      length += step;
  }
  const int end = static_cast<int>(i + length * direction);
  const KeyDifference node = keys.difference(i, end);
  int offset = 0;
  for (int step = static_cast<int>(length); step > 1;) {
    step = (step + 1) / 2;
    if (offset + step < length &&
        sharesMore(keys.difference(i, i + (offset + step) * direction), node))
      offset += step;
  }
  const int split = i + offset * direction + (direction < 0 ? -1 : 0);
  return {direction > 0 ? i : end, split, direction > 0 ? end : i};
}

void sortItems(const exec_space& space, const View<const Box*>& items, const Box& all, Bvh& tree) {
  const MortonGrid grid(all);
  tree.order.grow(space, tree.num_items);
  const auto codes = tree.order.keys;
  const auto values = tree.order.values;
  Kokkos::parallel_for(
      "contact::buildTree::codes", rangePolicy(space, tree.num_items),
      KOKKOS_LAMBDA(const std::int64_t item) {
        codes(item) = mortonCode(grid, items(item).centroid());
        values(item) = static_cast<int>(item);
      });
  sortByKey(space, tree.num_items, morton_bits, tree.order);
}

void connectNodes(const exec_space& space, const Bvh& tree) {
  const Keys keys{tree.order.keys, tree.num_items};
  const auto items = tree.order.values;
  const auto nodes = tree.nodes;
  const auto leaf_parent = tree.leaf_parent;
  Kokkos::parallel_for(
      "contact::buildTree::connect", rangePolicy(space, tree.num_items - 1),
      KOKKOS_LAMBDA(const std::int64_t n) {
        const int node = static_cast<int>(n);
        const Range range = rangeOfNode(keys, node);
        const int ends[2] = {range.first, range.last};
        for (int side = 0; side < 2; ++side) {
          const int child = range.split + side;
          if (child == ends[side]) {
            nodes(node).child[side] = ~items(child);
            leaf_parent(child) = 2 * node + side;
          } else {
            nodes(node).child[side] = child;
            nodes(child).parent = 2 * node + side;
          }
        }
        if (node == 0)
          nodes(0).parent = -1;
        nodes(node).visits = 0;
      });
}

// Each leaf climbs; of the two that meet at an inner node the second one knows both boxes and goes
// on.
void mergeBoxes(const exec_space& space, const View<const Box*>& items, const Bvh& tree) {
  const auto values = tree.order.values;
  const auto nodes = tree.nodes;
  const auto leaf_parent = tree.leaf_parent;
  Kokkos::parallel_for(
      "contact::buildTree::boxes", rangePolicy(space, tree.num_items),
      KOKKOS_LAMBDA(const std::int64_t leaf) {
        FloatBounds box = FloatBounds::of(items(values(leaf)));
        int parent = leaf_parent(leaf);
        while (parent >= 0) {
          TreeNode& node = nodes(parent / 2);
          node.setBox(parent % 2, box);
          orderMemory();
          if (Kokkos::atomic_fetch_add(&node.visits, 1) == 0)
            return;
          orderMemory();
          box.include(node.box(1 - parent % 2));
          parent = node.parent;
        }
      });
}

// A tree of one item: a root whose second child overlaps nothing.
void makeSingleLeaf(const exec_space& space, const View<const Box*>& items, const Bvh& tree) {
  const auto nodes = tree.nodes;
  Kokkos::parallel_for(
      "contact::buildTree::single", rangePolicy(space, 1), KOKKOS_LAMBDA(const std::int64_t) {
        nodes(0).setBox(0, FloatBounds::of(items(0)));
        nodes(0).setBox(1, FloatBounds());
        nodes(0).child[0] = nodes(0).child[1] = ~0;
        nodes(0).parent = -1;
      });
}

} // namespace

void buildTree(const exec_space& space, const View<const Box*>& items, int num_items,
               const Box& all, Bvh& tree) {
  tree.num_items = num_items;
  growTo(space, tree.nodes, maxOf(num_items - 1, 1));
  growTo(space, tree.leaf_parent, num_items);
  if (num_items == 0)
    return;
  if (num_items == 1)
    return makeSingleLeaf(space, items, tree);
  sortItems(space, items, all, tree);
  connectNodes(space, tree);
  mergeBoxes(space, items, tree);
}

} // namespace brickwall::contact
