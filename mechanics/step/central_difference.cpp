#include "mechanics/step/central_difference.hpp"

#include "contact/base/sum_over.hpp"
#include "mechanics/ledger/sum_limbs.hpp"
#include "mechanics/step/kick_packs.hpp"

#include <type_traits>

namespace brickwall::mechanics {

void drift(const exec_space& space, double dt, const NodalState& state) {
  const auto u = state.displacement;
  const auto v = state.velocity;
  if (u.span_is_contiguous() && v.span_is_contiguous()) { // and of the same layout
    double* const to = u.data();
    const double* const from = v.data();
    Kokkos::parallel_for(
        "mechanics::drift::nodes", rangePolicy(space, static_cast<std::int64_t>(u.span())),
        KOKKOS_LAMBDA(const std::int64_t k) { to[k] += dt * from[k]; });
    return;
  }
  Kokkos::parallel_for(
      "mechanics::drift::nodes",
      rangePolicy(space, static_cast<std::int64_t>(state.mass.extent(0))),
      KOKKOS_LAMBDA(const std::int64_t node) {
        for (int i = 0; i < 3; ++i)
          u(node, i) += dt * v(node, i);
      });
}

void drift(const exec_space& space, double dt, const NodalState& state,
           const NodeSelection& nodes) {
  const auto u = state.displacement;
  const auto v = state.velocity;
  Kokkos::parallel_for(
      "mechanics::drift::runs", rangePolicy(space, nodes.numRuns()),
      KOKKOS_LAMBDA(const std::int64_t r) {
        const NodeRun run = nodes.run(static_cast<int>(r));
        for (int node = run.first; node < run.first + run.count; ++node)
          for (int i = 0; i < 3; ++i)
            u(node, i) += dt * v(node, i);
      });
}

namespace {

// Kicks runs of nodes in packs of W, on a host.
template <int kinds, int W>
struct KickRuns {
  KickNode<kinds> node_kick;
  NodeSelection nodes;

  void operator()(const std::int64_t r, KickSums& sums) const {
    PackKicker<kinds, W> kicker(node_kick, sums);
    const NodeRun run = nodes.run(static_cast<int>(r));
    const std::int64_t end = static_cast<std::int64_t>(run.first) + run.count;
    for (std::int64_t first = run.first; first < end; first += W)
      kicker.kick(first, static_cast<int>(minOf<std::int64_t>(W, end - first)));
  }
};

template <int kinds>
KickSums launchKick(const exec_space& space, const NodeSelection& nodes,
                    const KickNode<kinds>& functor) {
  KickSums sums;
  if (nodes.numRuns() == 0)
    return sums;
  if constexpr (simd_width > 1)
    sums = sumOver<KickSums>("mechanics::kick::nodes", space, 0, nodes.numRuns(),
                             KickRuns<kinds, simd_width>{functor, nodes});
  else // On a device all nodes are kicked; the omitted ones are at rest and remain so.
    sums = sumStrided<num_kick_terms>("mechanics::kick::nodes", space, nodes.num_nodes,
                                      KickStrided<kinds>(functor, nodes.num_nodes));
  sums.carry();
  return sums;
}

} // namespace

KickSums kick(const exec_space& space, const HexMesh& mesh, const BoundaryConditions& boundary,
              const TimeSpan& drift, double dt, const NodalForces& forces, const NodalState& state,
              const LedgerScales& scales, const SpeedTest& test) {
  return kick(space, mesh, boundary, drift, dt, forces, state, scales, test,
              NodeSelection::allOf(mesh.num_nodes));
}

KickSums kick(const exec_space& space, const HexMesh& mesh, const BoundaryConditions& boundary,
              const TimeSpan& drift, double dt, const NodalForces& forces, const NodalState& state,
              const LedgerScales& scales, const SpeedTest& test, const NodeSelection& nodes,
              const DriftAhead& ahead) {
  const auto launch = [&](auto kinds) {
    return launchKick(space, nodes,
                      KickNode<decltype(kinds)::value>{
                          mesh.reference_coordinates, state.displacement, state.velocity,
                          state.mass, mesh.node_is_owned, forces.values, forces.quantum.value, dt,
                          boundary.during(drift), scales, test, forces.acts, forces.may_touch,
                          ahead});
  };
  KickSums sums = static_cast<int>(forces.values.extent(1)) == numForceColumns(true)
                      ? launch(std::integral_constant<int, num_force_kinds>())
                      : launch(std::integral_constant<int, viscous_force>());
  if (nodes.others_rest && !(dot(test.around, test.around) <= test.limit * test.limit))
    ++sums.sum[kick_fast_nodes].high; // The resting nodes are fast relative to the mean.
  return sums;
}

} // namespace brickwall::mechanics
