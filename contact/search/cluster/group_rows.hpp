// The kernel of the cluster search on devices: 32 nodes that follow each other in the kept order (a
// group) descend the tree of faces together and are tested against the same faces, each in a lane
// of its own.
#pragma once

#include "contact/search/cluster/cluster_rows.hpp"

namespace brickwall::contact {

// Finds the rows of groups. Rows are in blocks of one. A node near too many faces is left to
// FindRows: its row is marked needs_retry and counted.
struct FindRowsOfGroups {
  static constexpr int max_blocks = 96; // of a level, near nodes that search together
  static constexpr int max_row = 24; // faces of a row
  static constexpr int blocks_at_once = vector_lanes / block_size;
  static constexpr int team_size = host_accessible ? 1 : 4, teams_at_once = 6;
  static_assert(vector_lanes == GroupsNearPartners::nodes_of_group);
  using Policy =
      Kokkos::TeamPolicy<exec_space, Kokkos::LaunchBounds<team_size * vector_lanes, teams_at_once>,
                         launch_by_argument>;
  using Member = Policy::member_type;

  PairTest test;
  View<const float*> node_bounds;
  BoxTree face_tree, ghost_tree;
  View<const int*> capacity; // [node position] entries of `faces`
  View<const std::int64_t*> row_place; // [node position] into `faces`
  View<int*> row_begin; // [node position][begin, end] relative to row_place
  View<int*> faces;
  View<unsigned char*> changed; // [node position] 0: the row is the same as in the last search
  int num_nodes;
  GroupQueue queue;
  GroupsToSearch groups;

  // A face near a group.
  struct alignas(16) NearFace {
    FloatBounds box;
    unsigned own; // the nodes of the group that are its corners
    int face;
    global_id body; // with drop_same_body
  };
  struct alignas(16) Scratch {
    NearFace near[vector_lanes];
    FloatBounds all; // reach of the union of the nodes that search together
    global_id body[vector_lanes]; // of the nodes, with drop_same_body
    int blocks[2][max_blocks];
    int row[max_row][vector_lanes];
  };
  // The nodes of a group, one in each lane.
  struct Nodes {
    int first = 0; // position
    unsigned searching = 0; // the nodes that search together now
    global_id body = many_bodies; // to which all of these belong
    OfLanes<FloatBounds> reach; // of nodes that are not searched: nothing
    OfLanes<int> count; // faces of the row
    int num_blocks = 0; // tested
  };
  struct LaneCounts {
    int pairs = 0, overflowed = 0, skipped = 0;
  };

  KOKKOS_INLINE_FUNCTION int numGroups() const { return dividedUp(num_nodes, vector_lanes); }

  KOKKOS_INLINE_FUNCTION void operator()(const Member& team, PairCounts& sums) const {
    Scratch& scratch = *static_cast<Scratch*>(
        team.thread_scratch(0).get_shmem_aligned(sizeof(Scratch), alignof(Scratch)));
    PairCounts all;
    OfLanes<LaneCounts> counts;
    forLanes(team, [&](const int lane) { counts[lane] = LaneCounts(); });
    // Every thread has a first group and then takes the next one that is left. Few groups are near
    // partners: the queue would take longer.
    const std::int64_t num_threads = std::int64_t(team.league_size()) * team.team_size();
    std::int64_t group = std::int64_t(team.league_rank()) * team.team_size() + team.team_rank();
    while (group < numGroups()) {
      if (groups.has(static_cast<int>(group), numGroups()))
        all.blocks += findRows(team, static_cast<int>(group), scratch, counts);
      if (groups.kind == GroupKind::near) {
        group += num_threads;
        continue;
      }
      Kokkos::single(
          Kokkos::PerThread(team),
          [&](std::int64_t& next) {
            next = num_threads + Kokkos::atomic_fetch_add(&queue.num_taken(0), std::int64_t(1)) -
                   queue.taken_before;
          },
          group);
    }
    all.pairs = sumOfLanes(team, [&](const int lane) { return counts[lane].pairs; });
    all.overflowed = sumOfLanes(team, [&](const int lane) { return counts[lane].overflowed; });
    all.skipped = sumOfLanes(team, [&](const int lane) { return counts[lane].skipped; });
    Kokkos::single(Kokkos::PerThread(team), [&] { sums += all; });
  }

  // Returns the number of blocks tested.
  KOKKOS_INLINE_FUNCTION int findRows(const Member& team, int group, Scratch& scratch,
                                      OfLanes<LaneCounts>& counts) const {
    Nodes nodes;
    nodes.first = group * vector_lanes;
    forLanes(team, [&](const int lane) {
      const int position = nodes.first + lane;
      const bool is_searched = isSearched(position);
      for (int s = 0; s < 6; ++s)
        nodes.reach[lane].side[s] =
            is_searched ? -node_bounds(std::int64_t(position) * 6 + (s + 3) % 6) : -HUGE_VALF;
      if (test.drop_same_body)
        scratch.body[lane] = position < num_nodes
                                 ? test.surface.node_body(test.order.node_order(position))
                                 : many_bodies;
    });
    // Nodes between which the order jumps are near too many faces together: halves search then.
    int num_nodes_together = vector_lanes;
    for (int first = 0; first < vector_lanes;) {
      const bool fits = searchTogether(team, first, num_nodes_together, nodes, scratch);
      if (!fits && num_nodes_together > 1) {
        num_nodes_together /= 2;
        continue;
      }
      if (!fits)
        forLanes(team, [&](const int lane) {
          if (lane == first)
            nodes.count[lane] = max_row + 1;
        });
      first += num_nodes_together;
      while (first % (2 * num_nodes_together) == 0 && first < vector_lanes)
        num_nodes_together *= 2;
    }
    forLanes(team, [&](const int lane) {
      writeRow(nodes.first + lane, nodes.count[lane], &scratch.row[0][lane], counts[lane]);
    });
    return nodes.num_blocks;
  }

  // Finds the faces near `count` nodes, from lane `first` on. Returns false if there are too many.
  KOKKOS_INLINE_FUNCTION bool searchTogether(const Member& team, int first, int count, Nodes& nodes,
                                             Scratch& scratch) const {
    nodes.searching = (count < 32 ? (1u << count) - 1 : 0xffffffffu) << first;
    for (int s = 0; s < 6; ++s) {
      const float least = leastOfLanes(team, [&](const int lane) {
        return (nodes.searching >> lane & 1u) != 0 ? -nodes.reach[lane].side[s] : HUGE_VALF;
      });
      Kokkos::single(Kokkos::PerThread(team), [&] { scratch.all.side[s] = -least; });
    }
    forLanes(team, [&](const int lane) {
      if ((nodes.searching >> lane & 1u) != 0)
        nodes.count[lane] = 0;
    });
    const bool have_one_body =
        test.drop_same_body && lanesWhere(team, [&](const int lane) {
                                 return (nodes.searching >> lane & 1u) != 0 &&
                                        scratch.body[lane] != scratch.body[first];
                               }) == 0;
    nodes.body = have_one_body ? scratch.body[first] : many_bodies;
    return searchTree<false>(team, face_tree, nodes, scratch) &&
           searchTree<true>(team, ghost_tree, nodes, scratch);
  }

  KOKKOS_INLINE_FUNCTION bool isSearched(int position) const {
    return position < num_nodes &&
           (test.order.owned(position / cluster_size) >> position % cluster_size & 1u) != 0;
  }
  KOKKOS_FORCEINLINE_FUNCTION static int bitsBelow(unsigned bits, int lane) {
    return countBits(bits & ((1u << lane) - 1));
  }

  // Level by level. Returns false if a level has too many blocks near the nodes.
  template <bool of_ghosts>
  KOKKOS_INLINE_FUNCTION bool searchTree(const Member& team, const BoxTree& tree, Nodes& nodes,
                                         Scratch& scratch) const {
    if (tree.num_levels == 0)
      return true;
    int level = maxOf(0, tree.num_levels - 2), count = tree.numBlocks(level), from = 0;
    forLanes(team, [&](const int lane) {
      if (lane < block_size) // which is the most of the level below the root
        scratch.blocks[0][lane] = lane;
    });
    for (; level > 0; --level) {
      const global_id except = level == 1 && !of_ghosts ? nodes.body : many_bodies;
      count = listChildren(team, tree, level, scratch.all, except, scratch.blocks[from], count,
                           scratch.blocks[1 - from]);
      nodes.num_blocks += count;
      if (count > max_blocks)
        return false;
      from = 1 - from;
    }
    for (int first = 0; first < count; first += blocks_at_once)
      testFaces<of_ghosts>(team, tree, scratch.blocks[from], first, count, nodes, scratch);
    return true;
  }

  // Lists the boxes of these blocks that overlap the union, ascending, but for blocks of own faces
  // that all belong to the body `except`. Returns their number.
  KOKKOS_INLINE_FUNCTION int listChildren(const Member& team, const BoxTree& tree, int level,
                                          const FloatBounds& all, global_id except,
                                          const int* blocks, int count, int* children) const {
    constexpr int boxes_of_lane = 2; // loaded at once
    int found = 0;
    for (int first = 0; first < count; first += boxes_of_lane * blocks_at_once) {
      OfLanes<FloatBounds> box[boxes_of_lane];
      forLanes(team, [&](const int lane) {
        for (int k = 0; k < boxes_of_lane; ++k)
          box[k][lane] = boundsOfLane(
              tree.block(level, blocks[placeOfLane(first + k * blocks_at_once, lane, count)]),
              lane % block_size);
      });
      for (int k = 0; k < boxes_of_lane; ++k) {
        const int begin = first + k * blocks_at_once;
        const auto child = [&](const int lane) {
          return blocks[placeOfLane(begin, lane, count)] * block_size + lane % block_size;
        };
        const unsigned near = lanesWhere(team, [&](const int lane) {
          return begin + lane / block_size < count && isWithin(box[k][lane].side, all) &&
                 (except == many_bodies || test.order.block_body(child(lane)) != except);
        });
        forLanes(team, [&](const int lane) {
          const int to = found + bitsBelow(near, lane);
          if ((near >> lane & 1u) != 0 && to < max_blocks)
            children[to] = child(lane);
        });
        found += countBits(near);
      }
    }
    return found;
  }
  // The place in a list of `count` blocks whose boxes are those of a lane, from `first` on.
  KOKKOS_FORCEINLINE_FUNCTION static int placeOfLane(int first, int lane, int count) {
    return minOf(first + lane / block_size, count - 1);
  }

  // Tests the nodes against the faces of up to blocks_at_once blocks.
  template <bool of_ghosts>
  KOKKOS_INLINE_FUNCTION void testFaces(const Member& team, const BoxTree& tree, const int* blocks,
                                        int first, int count, Nodes& nodes,
                                        Scratch& scratch) const {
    OfLanes<NearFace> of_lane; // loaded at once, whether it is near or not
    forLanes(team, [&](const int lane) {
      const std::int64_t block = blocks[placeOfLane(first, lane, count)];
      const int item = static_cast<int>(block) * block_size + lane % block_size;
      NearFace& face = of_lane[lane];
      face.box = boundsOfLane(tree.block(0, block), lane % block_size);
      face.own = 0;
      if constexpr (of_ghosts) {
        face.face = test.surface.num_faces + item;
      } else {
        const int* const corner = &test.order.corners(block * 4 * block_size + lane % block_size);
        for (int k = 0; k < 4; ++k) {
          const auto at = static_cast<unsigned>(corner[k * block_size] - nodes.first);
          face.own |= at < 32u ? 1u << at : 0u;
        }
        face.face = test.order.face_order(minOf(item, test.surface.num_faces - 1));
      }
    });
    const unsigned near = lanesWhere(team, [&](const int lane) {
      return first + lane / block_size < count && isWithin(of_lane[lane].box.side, scratch.all);
    });
    if (near == 0)
      return;
    forLanes(team, [&](const int lane) {
      if ((near >> lane & 1u) == 0)
        return;
      NearFace& face = scratch.near[bitsBelow(near, lane)];
      face = of_lane[lane];
      if (test.drop_same_body)
        face.body = bodyOfSide(of_ghosts ? test.ghosts.bodies(face.face - test.surface.num_faces)
                                         : test.surface.face_body(face.face));
    });
    const int num_near = countBits(near);
    forLanes(team, [&](const int lane) {
      if ((nodes.searching >> lane & 1u) == 0)
        return;
      const FloatBounds reach = nodes.reach[lane];
      const unsigned self = 1u << lane;
      unsigned hits = 0;
      for (int i = 0; i < num_near; ++i) {
        const NearFace& face = scratch.near[i];
        const bool is_hit = isWithin(face.box.side, reach) & ((face.own & self) == 0);
        hits |= static_cast<unsigned>(is_hit) << i;
      }
      for (; hits != 0; hits &= hits - 1) {
        const NearFace& face = scratch.near[lowestBit(hits)];
        if (test.drop_same_body ? face.body == scratch.body[lane]
                                : of_ghosts && !isAllowed(nodes.first + lane, face.face))
          continue;
        if (overlaps(nodes.first + lane, reach, face))
          insert(face.face, &scratch.row[0][lane], nodes.count[lane]);
      }
    });
  }

  KOKKOS_INLINE_FUNCTION bool isAllowed(int position, int face) const {
    return test.rules.allow(test.order.node_order(position), face);
  }
  // Of boxes that overlap or touch in floats.
  KOKKOS_INLINE_FUNCTION bool overlaps(int position, const FloatBounds& reach,
                                       const NearFace& face) const {
    bool is_sure = true;
    for (int s = 0; s < 6; ++s)
      is_sure &= face.box.side[s] < reach.side[s];
    return is_sure || test.overlap(test.order.node_order(position), face.face);
  }
  // Inserts a face in order; `row` has the stride vector_lanes. The count may exceed max_row.
  KOKKOS_INLINE_FUNCTION void insert(int face, int* row, int& count) const {
    int to = count++;
    if (to >= max_row)
      return;
    for (; to > 0 && test.before(face, row[(to - 1) * vector_lanes]); --to)
      row[to * vector_lanes] = row[(to - 1) * vector_lanes];
    row[to * vector_lanes] = face;
  }

  KOKKOS_INLINE_FUNCTION void writeRow(int position, int count, const int* row,
                                       LaneCounts& counts) const {
    if (position >= num_nodes)
      return;
    int* const begin = &row_begin(std::int64_t(position) * 2);
    if (!isSearched(position)) {
      begin[0] = begin[1] = changed(position) = 0;
      return;
    }
    if (count > max_row) {
      begin[0] = needs_retry;
      ++counts.skipped;
      return;
    }
    bool is_new = begin[1] != count;
    begin[0] = 0;
    begin[1] = count;
    counts.pairs += count;
    changed(position) = 1;
    if (count > capacity(position)) {
      ++counts.overflowed;
      return;
    }
    int* const to = faces.data() + row_place(position);
    for (int i = 0; i < count; ++i)
      if (is_new || to[i] != row[i * vector_lanes]) {
        to[i] = row[i * vector_lanes];
        is_new = true;
      }
    changed(position) = is_new;
  }
};

// Launches FindRowsOfGroups, whose queue must be `queue`. With groups far from partners each
// multiprocessor gets a team less, so that the kernels that make the ghosts fit beside them.
template <class Find, class Space>
void launchByGroups(const exec_space& space, const Find& find,
                    const PlusReducer<PairCounts, Space>& counts, GroupQueue& queue) {
  constexpr int team_size = Find::team_size;
  const int teams_at_once = Find::teams_at_once - (find.groups.kind == GroupKind::far);
  const int fitting = // threads of `vector_lanes` lanes, by registers
      host_accessible ? concurrency(space) : concurrency(space) / 2048 * teams_at_once * team_size;
  const int num_teams = dividedUp(minOf(fitting, find.numGroups()), team_size);
  using Scratch = typename Find::Scratch;
  typename Find::Policy policy(space, num_teams, team_size, vector_lanes);
  policy.set_scratch_size(0, Kokkos::PerTeam(static_cast<int>(alignof(Scratch))),
                          Kokkos::PerThread(static_cast<int>(sizeof(Scratch))));
  Kokkos::parallel_reduce("contact::ClusterPairs::find", policy, find, counts);
  if (find.groups.kind != GroupKind::near)
    queue.taken_before += find.numGroups(); // every group makes its thread look for another one
}

} // namespace brickwall::contact
