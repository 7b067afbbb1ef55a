// Refit of the boxes of a surface on hosts: a cluster of nodes, or a block of faces, to each
// thread.
#pragma once

#include "contact/base/lanes.hpp"
#include "contact/search/cluster/surface_refit.hpp"

namespace brickwall::contact {

// Computes the bounds of the nodes of one cluster, and of the cluster. Rows of coordinates are
// gathered in the kept order.
struct RefitCluster : RefitInput {

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t cluster, RefitSums& all) const {
    const std::int64_t first = cluster * cluster_size;
    prefetchNodes(first + 4 * cluster_size); // the host's rows are scattered
    const double from[4] = {origin.x, origin.y, origin.z, 0};
    const unsigned is_owned = owned(cluster);
    float of_owned[8]; // eight, not six: one SIMD register
    for (float& side : of_owned)
      side = HUGE_VALF;
    for (int lane = 0; lane < cluster_size && first + lane < num_nodes; ++lane) {
      const int node = node_order(first + lane);
      double rows[2][4];
      const double* const a = rowOfFour(x_old, node, rows[0]);
      const double* const b = rowOfFour(x_new, node, rows[1]);
      float sides[8];
      const bool is_finite = sweptBox(a, b, face_tolerance, from, sides);
      if (!is_finite)
        skip(node, sides, all);
      storeRow(sides, &corner_bounds((first + lane) * 6));
      if (!same_bounds) {
        if (is_finite)
          sweptBox(a, b, node_tolerance, from, sides);
        storeRow(sides, &node_bounds((first + lane) * 6));
      }
      if ((is_owned >> lane & 1u) != 0)
        for (int s = 0; s < 8; ++s)
          of_owned[s] = sides[s] < of_owned[s] ? sides[s] : of_owned[s];
    }
    storeRow(of_owned, &cluster_bounds(cluster * 6));
    for (int s = 0; s < 6; ++s)
      all.owned_nodes.side[s] = minOf(all.owned_nodes.side[s], of_owned[s]);
  }

  KOKKOS_FORCEINLINE_FUNCTION void prefetchNodes(std::int64_t first) const {
    if constexpr (cluster_size > 1)
      for (int lane = 0; lane < cluster_size && first + cluster_size <= num_nodes; ++lane) {
        const int node = node_order(first + lane);
        prefetchRow(x_old, node);
        prefetchRow(x_new, node);
      }
  }

  // A row of coordinates of which sweptBox() may read four numbers: in place where it is contiguous
  // and another row follows, otherwise a copy.
  KOKKOS_INLINE_FUNCTION const double* rowOfFour(const View<const double* [3]>& x, int node,
                                                 double (&copy)[4]) const {
    if (cluster_size > 1 && x.stride_1() == 1 && node + 1 < num_nodes)
      return &x(node, 0);
    for (int d = 0; d < 3; ++d)
      copy[d] = x(node, d);
    copy[3] = 0;
    return copy;
  }
  KOKKOS_INLINE_FUNCTION static void storeRow(const float (&sides)[8], float* row) {
    for (int s = 0; s < 6; ++s)
      row[s] = sides[s];
  }
  // Counts a node that is not finite, which has no box.
  KOKKOS_INLINE_FUNCTION void skip(int node, float (&sides)[8], RefitSums& all) const {
    for (float& side : sides)
      side = HUGE_VALF;
    ++all.num_invalid;
    all.first_invalid = minOf(all.first_invalid, ids(node));
  }
};

// Computes the boxes of one block of faces, and their union as an item of the next level. The box
// of a face is the union of those of its corners, since rounding is monotone.
struct RefitBlock {
  BoxTree tree;
  View<const int*> corners;
  View<const float*> corner_bounds;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t block) const {
    const int* const corner = &corners(block * 4 * block_size);
    float* const boxes = tree.block(0, block);
    float all[8];
    for (int s = 0; s < 8; ++s)
      all[s] = HUGE_VALF;
    const int used = minOf<int>(block_size, tree.num_items - static_cast<int>(block) * block_size);
    for (int lane = 0; lane < used; ++lane) {
      float box[8]; // eight, not six: one SIMD register; the last two belong to the next node
      const float* from = &corner_bounds(std::int64_t(corner[lane]) * 6);
      for (int s = 0; s < 8; ++s)
        box[s] = from[s];
      float hole = box[0]; // infinite for a node that is not finite
      for (int k = 1; k < 4; ++k) {
        from = &corner_bounds(std::int64_t(corner[k * block_size + lane]) * 6);
        hole = maxOf(hole, from[0]);
        for (int s = 0; s < 8; ++s)
          box[s] = from[s] < box[s] ? from[s] : box[s];
      }
      if (hole == HUGE_VALF)
        for (int s = 0; s < 8; ++s)
          box[s] = HUGE_VALF;
      for (int s = 0; s < 8; ++s)
        all[s] = box[s] < all[s] ? box[s] : all[s];
      for (int s = 0; s < 6; ++s)
        boxes[s * block_size + lane] = box[s];
    }
    for (int lane = used; lane < block_size; ++lane)
      storeLane(boxes, lane, FloatBounds());
    if (tree.num_levels > 1) {
      float* const parent = tree.block(1, block / block_size);
      for (int s = 0; s < 6; ++s)
        parent[s * block_size + block % block_size] = all[s];
    }
  }
};

// Empties a lane of the last block of level 1 if there is no block below it.
struct EmptyLane {
  BoxTree tree;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t lane) const {
    const std::int64_t parent = tree.numBlocks(1) - 1;
    if (parent * block_size + lane >= tree.numBlocks(0))
      storeLane(tree.block(1, parent), static_cast<int>(lane), FloatBounds());
  }
};

struct HostRefit {
  template <class Input>
  static void refitNodes(const exec_space& space, const Input& input, RefitScratch&,
                         RefitSums& sums) {
    const auto num_clusters = static_cast<std::int64_t>(input.owned.extent(0));
    Kokkos::parallel_reduce("contact::SurfaceClusters::nodes", rangePolicy(space, num_clusters),
                            RefitCluster{input}, PlusReducer<RefitSums>(sums));
  }
  template <class Input>
  static void refitFaces(const exec_space& space, const Input& input, RefitScratch&, RefitSums&) {
    const BoxTree& tree = input.tree;
    if (tree.num_levels == 0)
      return;
    if (tree.num_levels > 1)
      Kokkos::parallel_for("contact::SurfaceClusters::empty_lanes", rangePolicy(space, block_size),
                           EmptyLane{tree});
    Kokkos::parallel_for("contact::SurfaceClusters::faces", rangePolicy(space, tree.numBlocks(0)),
                         RefitBlock{tree, input.corners, input.corner_bounds});
  }
  static void refitUpperLevels(const exec_space& space, BoxForest& forest, RefitSums& sums) {
    forest.refitUpperLevels(space, 2);
    space.fence();
    const BoxTree& tree = forest.tree(0);
    if (tree.num_levels > 0)
      sums.faces = unionOfBlock(tree.block(tree.num_levels - 1, 0));
  }
  static void read(const exec_space&, const RefitScratch&, RefitSums&) {} // they are complete
};

} // namespace brickwall::contact
