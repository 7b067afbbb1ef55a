// The kernel of the cluster search: a group of clusters finds the blocks of faces near it; each
// cluster tests its nodes against the faces of these blocks and writes its rows of candidates.
#pragma once

#include "contact/search/cluster/cluster_hits.hpp"
#include "contact/search/cluster/cluster_pairs.hpp"
#include "contact/search/cluster/cluster_walk.hpp"
#include "contact/surface/candidate_rows.hpp"
#include "contact/surface/face_access.hpp"

namespace brickwall::contact {

using DeviceRules = PairRules<memory_space>;

constexpr int row_width = cluster_size + 1; // entries of CandidatePairs::row_begin for a cluster
constexpr int needs_retry = -1; // in the first of them, which is otherwise 0
// Entries of a cluster before its first search: four faces per node.
constexpr int initial_capacity = 4 * cluster_size;
// Clusters that traverse the upper levels of the tree together, and the most blocks that they keep.
constexpr int group_size = cluster_size > 1 ? 8 : 1;
constexpr int max_near_blocks = cluster_size > 1 ? 512 : block_size;
// Blocks of faces near a group of clusters, with their boxes.
struct BlockList {
  float boxes[6][max_near_blocks + block_size];
  int block[max_near_blocks + block_size];
  int count = 0; // more than max_near_blocks: the list is incomplete

  // Adds those of the eight blocks, from `first` on, whose bit is set; `of` holds their boxes.
  KOKKOS_INLINE_FUNCTION void add(const float* of, std::int64_t first, unsigned bits) {
    int number[block_size];
    for (int lane = 0; lane < block_size; ++lane)
      number[lane] = static_cast<int>(first) + lane;
    if (count <= max_near_blocks) {
      for (int s = 0; s < 6; ++s)
        selectLanes(of + s * block_size, bits, boxes[s] + count);
      selectLanes(number, bits, block + count);
    }
    count += countBits(bits);
  }
  // Empties the lanes after the last block.
  KOKKOS_INLINE_FUNCTION void finish() {
    for (int i = count; i % block_size != 0 && i < max_near_blocks; ++i)
      boxes[0][i] = HUGE_VALF;
  }
};

// The input of the kernel, and the exact test of one pair.
struct PairTest {
  SweptBoxes surface;
  GhostFaces ghosts;
  ClusterOrder order;
  DeviceRules rules;
  double node_tolerance, face_tolerance;
  bool drop_same_body;

  // Whether the boxes overlap in doubles, for ties in floats.
  KOKKOS_INLINE_FUNCTION bool overlap(int node, int face) const {
    return FaceAccess{surface, ghosts}.boxesOverlap(node, face, node_tolerance, face_tolerance);
  }
  // By (side, face id).
  KOKKOS_INLINE_FUNCTION bool before(int a, int b) const {
    if (a < surface.num_faces && b < surface.num_faces && order.face_rank.extent(0) == 0)
      return a < b;
    return rules.before(a, b);
  }
};

// Searches one group of clusters.
struct FindRows {
  PairTest test;
  View<const float*> node_bounds, cluster_bounds;
  BoxTree face_tree, ghost_tree;
  View<const int*> capacity;
  View<const std::int64_t*> block_begin;
  View<int*> row_begin, faces;
  View<unsigned char*> changed; // [cluster] 0: the rows are the same as in the last search
  KeptHits kept;
  int num_clusters;
  bool repeat; // search only the clusters marked needs_retry

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t group, PairCounts& sums) const {
    const int first = static_cast<int>(group) * group_size;
    const int end = minOf(first + group_size, num_clusters);
    FloatBounds all;
    for (int cluster = first; cluster < end; ++cluster)
      if (isSearched(cluster))
        for (int s = 0; s < 6; ++s)
          all.side[s] = minOf(all.side[s], cluster_bounds(std::int64_t(cluster) * 6 + s));
    const global_id body = bodyOfClusters(first, end);
    BlockList near_faces, near_ghosts;
    sums.blocks += collect<false>(all.reach(), body, near_faces);
    collect<true>(all.reach(), body, near_ghosts);
    for (int cluster = first; cluster < end; ++cluster)
      if (isSearched(cluster))
        findRows(cluster, near_faces, near_ghosts, sums);
  }

  KOKKOS_INLINE_FUNCTION bool isSearched(int cluster) const {
    return !repeat || row_begin(std::int64_t(cluster) * row_width) == needs_retry;
  }

  // The body to which all nodes of these clusters belong, or many_bodies.
  KOKKOS_INLINE_FUNCTION global_id bodyOfClusters(int first, int end) const {
    const global_id body = test.order.bodyOfCluster(first);
    for (int cluster = first + 1; cluster < end; ++cluster)
      if (test.order.bodyOfCluster(cluster) != body)
        return many_bodies;
    return body;
  }
  KOKKOS_INLINE_FUNCTION bool isOfBody(std::int64_t block, global_id body) const {
    return body != many_bodies && test.order.block_body(block) == body;
  }

  template <bool of_ghosts>
  KOKKOS_INLINE_FUNCTION const BoxTree& treeOf() const {
    return of_ghosts ? ghost_tree : face_tree;
  }

  // Lists the blocks of faces near a group, but for those of the body to which it belongs. Returns
  // the number of blocks tested and listed.
  template <bool of_ghosts>
  KOKKOS_INLINE_FUNCTION std::int64_t collect(const FloatBounds& reach, global_id body,
                                              BlockList& list) const {
    const BoxTree& tree = treeOf<of_ghosts>();
    if (group_size == 1 || tree.num_levels < 2)
      return 0;
    int num_tested = 0;
    const auto addChildren = [&](const std::int64_t parent) {
      const float* const boxes = tree.block(1, parent);
      unsigned near = lanesOverlapping(boxes, reach);
      if (!of_ghosts && body != many_bodies)
        for (unsigned rest = near; rest != 0; rest &= rest - 1)
          if (isOfBody(parent * block_size + lowestBit(rest), body))
            near &= ~(rest & (~rest + 1));
      list.add(boxes, parent * block_size, near);
      ++num_tested;
      return list.count <= max_near_blocks;
    };
    if (tree.num_levels > 2)
      num_tested += walkLevels(tree, tree.num_levels - 1, 0, 2, reach, addChildren);
    else
      addChildren(0);
    list.finish();
    for (int i = 0; i < minOf(list.count, max_near_blocks); ++i) {
      prefetchBlock(tree.block(0, list.block[i]));
      if (!of_ghosts && body == many_bodies)
        test.order.prefetchCorners(list.block[i]);
    }
    return std::int64_t(num_tested) + list.count;
  }

  // Tests a cluster against the blocks of a tree that it overlaps, ascending; `list` holds those
  // near its group.
  template <bool of_ghosts>
  KOKKOS_INLINE_FUNCTION void testTree(const NodeCluster& nodes, int first, global_id body,
                                       const BlockList& list, Hits& hits) const {
    const BoxTree& tree = treeOf<of_ghosts>();
    if (group_size > 1 && tree.num_levels >= 2 && list.count <= max_near_blocks) {
      int near[max_near_blocks + block_size];
      int count = 0;
      for (int i = 0; i < list.count; i += block_size) {
        const unsigned bits =
            lanesWithin(list.boxes[0] + i, max_near_blocks + block_size, nodes.all.side);
        selectLanes(list.block + i, bits, near + count);
        count += countBits(bits);
      }
      for (int i = 0; i < count; i += blocks_at_once)
        testBlocks<of_ghosts>(nodes, first, body, near + i, minOf(count - i, blocks_at_once), hits);
      return;
    }
    walkBlocks(tree, nodes.all, [&](const std::int64_t block) {
      const int number = static_cast<int>(block);
      testBlocks<of_ghosts>(nodes, first, body, &number, 1, hits);
    });
  }

  KOKKOS_INLINE_FUNCTION void findRows(int cluster, const BlockList& near_faces,
                                       const BlockList& near_ghosts, PairCounts& sums) const {
    int* const begin = &row_begin(std::int64_t(cluster) * row_width);
    const unsigned owned = test.order.owned(cluster);
    changed(cluster) = owned != 0;
    if (owned == 0) {
      for (int lane = 0; lane <= cluster_size; ++lane)
        begin[lane] = 0;
      return;
    }
    if constexpr (cluster_size > 1)
      kept.prefetchHits(cluster);
    const int first = cluster * cluster_size;
    NodeCluster nodes;
    nodes.load(&node_bounds(std::int64_t(first) * 6), &cluster_bounds(std::int64_t(cluster) * 6),
               owned);
    Hits hits;
    const global_id body = test.order.bodyOfCluster(cluster);
    testTree<false>(nodes, first, body, near_faces, hits);
    testTree<true>(nodes, first, body, near_ghosts, hits);
    const bool is_long = hits.count > max_hits;
    if constexpr (cluster_size > 1) {
      if (hits.are_own && hits.count <= max_sorted_hits) {
        resolveFloatTies(first, hits);
        if (!repeat && kept.areEqual(cluster, hits)) {
          sums.pairs += begin[cluster_size];
          changed(cluster) = 0;
          return;
        }
        kept.keep(cluster, hits);
        applyRules(first, hits);
        selectRows(hits, cluster, begin, sums);
        return;
      }
      kept.count(cluster) = 0;
    }
    if (!is_long) {
      resolveFloatTies(first, hits);
      applyRules(first, hits);
    }
    fillRows(nodes, first, hits, is_long, cluster, begin, sums);
  }

  // Rows of few own faces: the faces are sorted once, and each node selects its own.
  KOKKOS_INLINE_FUNCTION void selectRows(Hits& hits, int cluster, int* begin,
                                         PairCounts& sums) const {
    int selected[max_sorted_hits * cluster_size + 16]; // selectByBit() writes beyond its result
    int total = 0;
    int difference = repeat; // the contents of a new part are undefined
    sortTogether(hits.key, hits.item, hits.lanes, hits.count);
    for (int lane = 0; lane < cluster_size; ++lane) {
      difference |= begin[lane] ^ total;
      begin[lane] = total;
      total += selectByBit(hits.item, hits.lanes, hits.count, lane, selected + total);
    }
    difference |= begin[cluster_size] ^ total;
    begin[cluster_size] = total;
    sums.pairs += total;
    if (total > capacity(cluster)) {
      kept.count(cluster) = 0; // no rows are written
      ++sums.overflowed;
      return;
    }
    int* const rows = faces.data() + block_begin(cluster);
    for (int i = 0; i < total; ++i) {
      difference |= rows[i] ^ selected[i];
      rows[i] = selected[i];
    }
    changed(cluster) = difference != 0;
  }

  // The general case: rows are counted, written and sorted.
  KOKKOS_INLINE_FUNCTION void fillRows(const NodeCluster& nodes, int first, Hits& hits,
                                       bool is_long, int cluster, int* begin,
                                       PairCounts& sums) const {
    const auto forAll = [&](const auto& visit) {
      if (is_long)
        forAllPairs(nodes, first, visit);
      for (int i = 0; i < hits.count && !is_long; ++i)
        visit(hits.item[i], hits.lanes[i]);
    };
    int length[cluster_size] = {};
    forAll([&](int, unsigned lanes) {
      for (int lane = 0; lane < cluster_size; ++lane)
        length[lane] += static_cast<int>(lanes >> lane & 1u);
    });
    std::int64_t total = 0;
    int next[cluster_size];
    for (int lane = 0; lane < cluster_size; ++lane) {
      begin[lane] = next[lane] = static_cast<int>(total);
      total += length[lane];
    }
    begin[cluster_size] = static_cast<int>(total);
    sums.pairs += total;
    sums.largest = maxOf(sums.largest, total);
    if (total > capacity(cluster)) {
      ++sums.overflowed;
      return;
    }
    int* const rows = faces.data() + block_begin(cluster);
    forAll([&](int face, unsigned lanes) {
      for (; lanes != 0; lanes &= lanes - 1)
        rows[next[lowestBit(lanes)]++] = face;
    });
    for (int lane = 0; lane < cluster_size; ++lane)
      sortRow(rows + begin[lane], begin[lane + 1] - begin[lane],
              [&](const int a, const int b) { return test.before(a, b); });
  }

  // Tests a cluster against the faces of these blocks: its union against each block, then its nodes
  // against the faces found, without branching, since whether a face is near is unpredictable.
  // `body`: of the cluster. Blocks of another body have no corner in the cluster.
  template <bool of_ghosts>
  KOKKOS_INLINE_FUNCTION void testBlocks(const NodeCluster& nodes, int first, global_id body,
                                         const int* blocks, int count, Hits& hits) const {
    if (hits.count > max_hits)
      return;
    const BoxTree& tree = treeOf<of_ghosts>();
    constexpr int most = (blocks_at_once + 1) * block_size;
    int near[most];
    unsigned own[most]; // nodes of the cluster that are corners of the face
    int num_near = 0;
    for (int i = 0; i < count; ++i) {
      const std::int64_t block = blocks[i];
      if (!of_ghosts && isOfBody(block, body))
        continue;
      const unsigned lanes = lanesOverlapping(tree.block(0, block), nodes.all);
      unsigned own_of_lanes[block_size] = {};
      if (!of_ghosts && (body == many_bodies || test.order.block_body(block) == many_bodies)) {
        bitsOfNumbers(&test.order.corners(block * 4 * block_size), first, own_of_lanes);
        hits.may_be_same_body = true;
      }
      int number[block_size];
      for (int lane = 0; lane < block_size; ++lane)
        number[lane] = blocks[i] * block_size + lane;
      selectLanes(number, lanes, near + num_near);
      selectLanes(own_of_lanes, lanes, own + num_near);
      num_near += countBits(lanes);
    }
    for (int i = 0; i < num_near; ++i) {
      const float* const box = tree.block(0, near[i] / block_size) + near[i] % block_size;
      const LanesReached reached = lanesReaching<cluster_size>(nodes.lanes, box, block_size);
      const unsigned lanes = reached.all & ~own[i];
      hits.item[hits.count] = (of_ghosts ? test.surface.num_faces : 0) + near[i];
      hits.lanes[hits.count] = lanes;
      hits.surely[hits.count] = reached.surely;
      hits.count += lanes != 0;
      hits.are_own &= !of_ghosts || lanes == 0;
    }
  }

  // Removes the lanes whose boxes overlap in floats only.
  KOKKOS_INLINE_FUNCTION void resolveFloatTies(int first, Hits& hits) const {
    unsigned any = 0;
    for (int i = 0; i < hits.count; ++i)
      any |= hits.lanes[i] & ~hits.surely[i];
    if (any == 0)
      return;
    for (int i = 0; i < hits.count; ++i)
      if (const unsigned unsure = hits.lanes[i] & ~hits.surely[i]; unsure != 0)
        hits.lanes[i] ^= unsure ^ overlapping(unsure, first, faceOf(hits.item[i]));
  }
  KOKKOS_INLINE_FUNCTION int faceOf(int item) const {
    return item < test.surface.num_faces ? test.order.face_order(item) : item;
  }
  // Items become faces, lanes those of the nodes that may touch them.
  KOKKOS_INLINE_FUNCTION void applyRules(int first, Hits& hits) const {
    const bool is_ranked = test.order.face_rank.extent(0) > 0;
    int num_kept = 0;
    for (int i = 0; i < hits.count; ++i) {
      const int item = hits.item[i];
      const bool is_own = item < test.surface.num_faces;
      const int face = faceOf(item);
      unsigned lanes = hits.lanes[i];
      if (!is_own || (test.drop_same_body && hits.may_be_same_body))
        lanes = allowed(lanes, first, face);
      hits.item[num_kept] = face;
      hits.key[num_kept] = is_own && is_ranked ? test.order.face_rank(item) : face;
      hits.lanes[num_kept] = lanes;
      num_kept += lanes != 0;
    }
    hits.count = num_kept;
  }
  KOKKOS_INLINE_FUNCTION unsigned allowed(unsigned lanes, int first, int face) const {
    unsigned kept = 0;
    for (; lanes != 0; lanes &= lanes - 1)
      if (test.rules.allow(test.order.node_order(first + lowestBit(lanes)), face))
        kept |= lanes & (~lanes + 1);
    return kept;
  }
  KOKKOS_INLINE_FUNCTION unsigned overlapping(unsigned lanes, int first, int face) const {
    unsigned kept = 0;
    for (; lanes != 0; lanes &= lanes - 1)
      if (test.overlap(test.order.node_order(first + lowestBit(lanes)), face))
        kept |= lanes & (~lanes + 1);
    return kept;
  }

  // Calls visit(face, lanes) for all pairs of a cluster with more than max_hits hits, block by
  // block.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void forAllPairs(const NodeCluster& nodes, int first,
                                          const Visit& visit) const {
    forAllPairs<false>(nodes, first, visit);
    forAllPairs<true>(nodes, first, visit);
  }
  template <bool of_ghosts, class Visit>
  KOKKOS_INLINE_FUNCTION void forAllPairs(const NodeCluster& nodes, int first,
                                          const Visit& visit) const {
    Hits hits;
    walkBlocks(treeOf<of_ghosts>(), nodes.all, [&](const std::int64_t block) {
      const int number = static_cast<int>(block);
      hits.count = 0;
      testBlocks<of_ghosts>(nodes, first, many_bodies, &number, 1, hits);
      resolveFloatTies(first, hits);
      applyRules(first, hits);
      for (int i = 0; i < hits.count; ++i)
        visit(hits.item[i], hits.lanes[i]);
    });
  }
};

} // namespace brickwall::contact
