// Refit of the boxes of a surface on devices: a node, and then a face, to each thread, with rows
// and blocks written as a whole, and in three launches. The boxes have the bits of HostRefit.
#pragma once

#include "contact/base/lanes.hpp"
#include "contact/search/cluster/surface_refit.hpp"

namespace brickwall::contact {

// Computes the bounds of the nodes, 32 at a time; each team stores its sums.
struct RefitNodes {
  static constexpr int team_size = host_accessible ? 1 : 4;
  using Policy = Kokkos::TeamPolicy<exec_space, Kokkos::LaunchBounds<team_size * vector_lanes, 8>,
                                    launch_by_argument>;
  using Member = Policy::member_type;

  RefitInput input;
  View<RefitSums*> sums; // [team]

  struct Scratch {
    float corner_rows[6 * vector_lanes], node_rows[6 * vector_lanes];
  };
  static constexpr std::size_t team_scratch = team_size * sizeof(RefitSums) + alignof(RefitSums);

  KOKKOS_INLINE_FUNCTION void operator()(const Member& team) const {
    Scratch& rows = *static_cast<Scratch*>(team.thread_scratch(0).get_shmem(sizeof(Scratch)));
    OfLanes<RefitSums> of_lane;
    forLanes(team, [&](const int lane) { of_lane[lane] = RefitSums(); });
    const std::int64_t thread = team.league_rank() * team.team_size() + team.team_rank();
    const std::int64_t stride = std::int64_t(team.league_size()) * team.team_size() * vector_lanes;
    for (std::int64_t first = thread * vector_lanes; first < input.num_nodes; first += stride) {
      forLanes(team, [&](const int lane) {
        if (first + lane < input.num_nodes)
          refitNode(first + lane, rows.corner_rows + 6 * lane, rows.node_rows + 6 * lane,
                    of_lane[lane]);
      });
      forLanes(team, [&](const int lane) {
        for (int i = lane;
             i < 6 * vector_lanes && 6 * first + i < 6 * std::int64_t(input.num_nodes);
             i += vector_lanes) {
          input.corner_bounds(6 * first + i) = rows.corner_rows[i];
          if (!input.same_bounds)
            input.node_bounds(6 * first + i) = rows.node_rows[i];
        }
      });
    }
    RefitSums all;
    for (int s = 0; s < 6; ++s)
      all.owned_nodes.side[s] =
          leastOfLanes(team, [&](const int lane) { return of_lane[lane].owned_nodes.side[s]; });
    all.num_invalid = sumOfLanes(team, [&](const int lane) { return of_lane[lane].num_invalid; });
    all.first_invalid =
        leastOfLanes(team, [&](const int lane) { return of_lane[lane].first_invalid; });
    auto* const of_threads = static_cast<RefitSums*>(team.team_scratch(0).get_shmem_aligned(
        team.team_size() * sizeof(RefitSums), alignof(RefitSums)));
    Kokkos::single(Kokkos::PerThread(team), [&] { of_threads[team.team_rank()] = all; });
    team.team_barrier();
    Kokkos::single(Kokkos::PerTeam(team), [&] {
      for (int t = 1; t < team.team_size(); ++t)
        of_threads[0] += of_threads[t];
      sums(team.league_rank()) = of_threads[0];
    });
  }

  KOKKOS_INLINE_FUNCTION void refitNode(std::int64_t position, float* corner_row, float* node_row,
                                        RefitSums& of_lane) const {
    const int node = input.node_order(position);
    const double origin[4] = {input.origin.x, input.origin.y, input.origin.z, 0};
    double a[4], b[4] = {0, 0, 0, 0};
    for (int d = 0; d < 3; ++d) {
      a[d] = input.x_old(node, d);
      b[d] = input.x_new(node, d);
    }
    a[3] = 0;
    float sides[8];
    const bool is_finite = sweptBox(a, b, input.face_tolerance, origin, sides);
    if (!is_finite) {
      for (int s = 0; s < 6; ++s)
        sides[s] = HUGE_VALF;
      ++of_lane.num_invalid;
      of_lane.first_invalid = minOf(of_lane.first_invalid, input.ids(node));
    }
    for (int s = 0; s < 6; ++s)
      corner_row[s] = sides[s];
    if (!input.same_bounds) {
      if (is_finite)
        sweptBox(a, b, input.node_tolerance, origin, sides);
      for (int s = 0; s < 6; ++s)
        node_row[s] = sides[s];
    }
    if ((input.owned(position / cluster_size) >> static_cast<int>(position % cluster_size) & 1u) !=
        0)
      for (int s = 0; s < 6; ++s)
        of_lane.owned_nodes.side[s] = minOf(of_lane.owned_nodes.side[s], sides[s]);
  }
};

// Computes the boxes of the faces of a tile, the blocks of the next two levels above them, and
// their union as a box of level 3.
struct RefitTile {
  static constexpr int blocks = block_size * block_size, faces = blocks * block_size; // of a tile
  static constexpr int team_size = host_accessible ? 1 : 256;
  using Policy =
      Kokkos::TeamPolicy<exec_space, Kokkos::LaunchBounds<team_size, 4>, launch_by_argument>;
  using Member = Policy::member_type;

  View<const int*> corners;
  View<const float*> corner_bounds;
  BoxTree tree;

  struct alignas(16) Scratch {
    float boxes[blocks * block_floats], parents[block_size * block_floats], top[block_floats];
  };

  KOKKOS_INLINE_FUNCTION void operator()(const Member& team) const {
    Scratch& scratch = *static_cast<Scratch*>(
        team.team_scratch(0).get_shmem_aligned(sizeof(Scratch), alignof(Scratch)));
    const int tile = team.league_rank();
    const int num_blocks = minOf(blocks, tree.numBlocks(0) - tile * blocks);
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, faces), [&](const int i) {
      storeLane(scratch.boxes + i / block_size * block_floats, i % block_size,
                boundsOfFace(std::int64_t(tile) * faces + i));
    });
    team.team_barrier();
    copyBlocks(team, scratch.boxes, tree.block(0, std::int64_t(tile) * blocks), num_blocks);
    Kokkos::parallel_for(
        Kokkos::TeamThreadRange(team, block_size * block_floats), [&](const int i) {
          const int side = i % block_floats / block_size;
          const int block = i / block_floats * block_size + i % block_size;
          scratch.parents[i] = block < num_blocks
                                   ? leastOfSide(scratch.boxes + block * block_floats, side)
                                   : HUGE_VALF;
        });
    team.team_barrier();
    if (tree.num_levels > 1)
      copyBlocks(team, scratch.parents, tree.block(1, std::int64_t(tile) * block_size),
                 dividedUp<std::int64_t>(num_blocks, block_size));
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, block_floats), [&](const int i) {
      scratch.top[i] = leastOfSide(scratch.parents + i % block_size * block_floats, i / block_size);
    });
    team.team_barrier();
    if (tree.num_levels > 2)
      copyBlocks(team, scratch.top, tree.block(2, tile), 1);
    Kokkos::single(Kokkos::PerTeam(team), [&] { finish(scratch, tile); });
  }

private:
  // A node's bounds as they lie in memory.
  struct alignas(8) Pair {
    float a, b;
  };
  struct alignas(16) Quarter { // half of a side
    float numbers[4];
  };
  static constexpr int quarters = block_floats / 4;

  KOKKOS_INLINE_FUNCTION static void copyBlocks(const Member& team, const float* from, float* to,
                                                int count) {
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, count * quarters), [&](const int i) {
      reinterpret_cast<Quarter*>(to)[i] = reinterpret_cast<const Quarter*>(from)[i];
    });
  }

  KOKKOS_INLINE_FUNCTION FloatBounds boundsOfFace(std::int64_t position) const {
    FloatBounds box;
    if (position >= tree.num_items)
      return box;
    const int* const corner =
        &corners(position / block_size * 4 * block_size + position % block_size);
    float hole = -HUGE_VALF; // infinite for a node that is not finite
    for (int k = 0; k < 4; ++k) {
      const auto* const from =
          reinterpret_cast<const Pair*>(&corner_bounds(std::int64_t(corner[k * block_size]) * 6));
      FloatBounds of_corner;
      for (int s = 0; s < 6; s += 2) {
        const Pair two = from[s / 2];
        of_corner.side[s] = two.a;
        of_corner.side[s + 1] = two.b;
      }
      hole = maxOf(hole, of_corner.side[0]);
      box.include(of_corner);
    }
    return hole == HUGE_VALF ? FloatBounds() : box;
  }

  KOKKOS_INLINE_FUNCTION static float leastOfSide(const float* block, int side) {
    float least = HUGE_VALF;
    for (int lane = 0; lane < block_size; ++lane)
      least = minOf(least, block[side * block_size + lane]);
    return least;
  }

  KOKKOS_INLINE_FUNCTION void finish(const Scratch& scratch, int tile) const {
    if (tree.num_levels <= 3)
      return;
    float* const block = tree.block(3, tile / block_size);
    storeLane(block, tile % block_size, unionOfBlock(scratch.top));
    if (tile + 1 == tree.numBlocks(2))
      for (int lane = tile % block_size + 1; lane < block_size; ++lane)
        storeLane(block, lane, FloatBounds());
  }
};

// Computes the levels above RefitTile, and adds the sums of all nodes, in one team.
struct RefitTop {
  static constexpr int team_size = host_accessible ? 1 : 256;
  static constexpr int num_parts = 256; // of the sums, a power of two
  using Policy =
      Kokkos::TeamPolicy<exec_space, Kokkos::LaunchBounds<team_size, 1>, launch_by_argument>;
  using Member = Policy::member_type;

  BoxTree tree;
  View<const RefitSums*> node_sums;
  std::int64_t num_node_sums;
  View<RefitSums> sums;

  KOKKOS_INLINE_FUNCTION void operator()(const Member& team) const {
    refitLevels(team, tree, 4);
    auto* const parts = static_cast<RefitSums*>(
        team.team_scratch(0).get_shmem_aligned(num_parts * sizeof(RefitSums), alignof(RefitSums)));
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, num_parts), [&](const int i) {
      RefitSums part;
      for (std::int64_t k = i; k < num_node_sums; k += num_parts)
        part += node_sums(k);
      parts[i] = part;
    });
    team.team_barrier();
    for (int half = num_parts / 2; half > 0; half /= 2) {
      Kokkos::parallel_for(Kokkos::TeamThreadRange(team, half),
                           [&](const int i) { parts[i] += parts[i + half]; });
      team.team_barrier();
    }
    Kokkos::single(Kokkos::PerTeam(team), [&] {
      if (tree.num_levels > 0)
        parts[0].faces = unionOfBlock(tree.block(tree.num_levels - 1, 0));
      sums() = parts[0];
    });
  }
};

struct TeamRefit {
  // Launches the kernel of the nodes.
  template <class Input>
  static void refitNodes(const exec_space& space, const Input& input, RefitScratch& scratch,
                         RefitSums&) {
    const std::int64_t groups = dividedUp<std::int64_t>(input.num_nodes, vector_lanes);
    const std::int64_t fitting =
        host_accessible ? concurrency(space) : concurrency(space) / vector_lanes;
    const auto teams =
        static_cast<int>(dividedUp<std::int64_t>(minOf(groups, fitting), RefitNodes::team_size));
    scratch.num_node_sums = teams;
    growTo(space, scratch.node_sums, scratch.num_node_sums);
    launch(space, "contact::SurfaceClusters::nodes", teams, vector_lanes, RefitNodes::team_scratch,
           sizeof(RefitNodes::Scratch), RefitNodes{input, scratch.node_sums});
  }
  // Launches the others; read() waits for the sums.
  template <class Input>
  static void refitFaces(const exec_space& space, const Input& input, RefitScratch& scratch,
                         RefitSums&) {
    const BoxTree& tree = input.tree;
    const int tiles = dividedUp(tree.num_items, RefitTile::faces);
    launch(space, "contact::SurfaceClusters::faces", tiles, 1,
           sizeof(RefitTile::Scratch) + alignof(RefitTile::Scratch), 0,
           RefitTile{input.corners, input.corner_bounds, tree});
    launch(space, "contact::SurfaceClusters::upper_levels", 1, 1,
           RefitTop::num_parts * sizeof(RefitSums) + alignof(RefitSums), 0,
           RefitTop{tree, scratch.node_sums, scratch.num_node_sums, scratch.sums});
    Kokkos::deep_copy(space, scratch.host_sums, scratch.sums);
  }
  static void refitUpperLevels(const exec_space&, BoxForest&, RefitSums&) {}
  static void read(const exec_space& space, const RefitScratch& scratch, RefitSums& sums) {
    space.fence();
    sums = scratch.host_sums();
  }

private:
  template <class Kernel>
  static void launch(const exec_space& space, const char* label, int teams, int lanes,
                     std::size_t team_scratch, std::size_t thread_scratch, const Kernel& kernel) {
    if (teams == 0)
      return;
    typename Kernel::Policy policy(space, teams, Kernel::team_size, lanes);
    policy.set_scratch_size(0, Kokkos::PerTeam(static_cast<int>(team_scratch)),
                            Kokkos::PerThread(static_cast<int>(thread_scratch)));
    Kokkos::parallel_for(label, policy, kernel);
  }
};

} // namespace brickwall::contact
