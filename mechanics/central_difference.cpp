#include "mechanics/central_difference.hpp"

#include "mechanics/kick_kernel.hpp"

#include <type_traits>

namespace brickwall::mechanics {

void drift(const exec_space& space, double dt, const NodalState& state) {
  const auto u = state.displacement;
  const auto v = state.velocity;
  if (u.span_is_contiguous() && v.span_is_contiguous()) { // and of one layout
    double* const to = u.data();
    const double* const from = v.data();
    Kokkos::parallel_for(
        "mechanics::drift::nodes", over(space, static_cast<std::int64_t>(u.span())),
        KOKKOS_LAMBDA(const std::int64_t k) { to[k] += dt * from[k]; });
    return;
  }
  Kokkos::parallel_for(
      "mechanics::drift::nodes", over(space, static_cast<std::int64_t>(state.mass.extent(0))),
      KOKKOS_LAMBDA(const std::int64_t node) {
        for (int i = 0; i < 3; ++i)
          u(node, i) += dt * v(node, i);
      });
}

namespace {

// Runs of nodes on a host, in packs of W. Nodes that anything but the internal force acts on are kicked one by one.
constexpr int nodes_per_run = 1024;
template <int kinds, int W>
struct KickRuns {
  KickNode<kinds> node_kick;
  std::int64_t num_nodes;

  void operator()(const std::int64_t run, KickSums& sums) const {
    PackKicker<kinds, W> kicker(node_kick, sums);
    const std::int64_t end = minOf((run + 1) * nodes_per_run, num_nodes);
    for (std::int64_t first = run * nodes_per_run; first < end; first += W)
      if (end - first < W || !kicker.isFree(first) || !kickPack(kicker, first))
        for (std::int64_t node = first; node < minOf(first + W, end); ++node)
          node_kick(node, sums);
  }

  // Does nothing and returns false when other forces act.
  bool kickPack(PackKicker<kinds, W>& kicker, std::int64_t first) const {
    const std::int64_t* const rows = &node_kick.forces(first, 0);
    std::int64_t force[3][W], is_owned[W], others = 0;
    for (int lane = 0; lane < W; ++lane) {
      const std::int64_t* const row = rows + 3 * kinds * lane;
      for (int i = 0; i < 3; ++i)
        force[i][lane] = row[i];
      for (int i = 3; i < 3 * kinds; ++i)
        others |= row[i];
      is_owned[lane] = -static_cast<std::int64_t>(node_kick.is_owned(first + lane) != 0);
    }
    if (others != 0)
      return false;
    IntPackOf<W> f[3], owned;
    for (int i = 0; i < 3; ++i)
      memcpy(&f[i].v, force[i], sizeof f[i].v);
    memcpy(&owned.v, is_owned, sizeof owned.v);
    PackOf<W> u[3];
    loadTriples(&node_kick.displacement(first, 0), u);
    kicker.kickPlain(first, f, u, owned);
    return true;
  }
};

template <int kinds>
KickSums launchKick(const exec_space& space, int num_nodes, const KickNode<kinds>& functor) {
  KickSums sums;
  if constexpr (simd_width > 1)
    Kokkos::parallel_reduce(
        "mechanics::kick::nodes", over(space, (num_nodes + nodes_per_run - 1) / nodes_per_run),
        KickRuns<kinds, simd_width>{functor, num_nodes}, Combine<KickSums>(sums));
  else
    Kokkos::parallel_reduce("mechanics::kick::nodes", over(space, num_nodes), functor,
                            Combine<KickSums>(sums));
  space.fence();
  sums.carry();
  return sums;
}

} // namespace

KickSums kick(const exec_space& space, const HexMesh& mesh, const BoundaryConditions& boundary,
              double time, double dt, const NodalForces& forces, const NodalState& state,
              const LedgerScales& scales, const SpeedTest& test) {
  const auto launch = [&](auto kinds) {
    return launchKick(space, mesh.num_nodes,
                      KickNode<decltype(kinds)::value>{
                          mesh.reference_coordinates, state.displacement, state.velocity,
                          state.mass, mesh.node_is_owned, forces.values, forces.quantum.value, dt,
                          boundary.at(time), scales, test});
  };
  return static_cast<int>(forces.values.extent(1)) == numForceColumns(true)
             ? launch(std::integral_constant<int, num_force_kinds>())
             : launch(std::integral_constant<int, viscous_force>());
}

} // namespace brickwall::mechanics
