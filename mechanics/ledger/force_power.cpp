#include "mechanics/ledger/force_power.hpp"

#include "contact/base/mpi.hpp"

namespace brickwall::mechanics {

double forcePower(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                  const NodalForces& forces, const NodalState& state, ForceKind kind,
                  const LedgerScales& scales) {
  const MeshViews m = viewsOf(mesh);
  const auto values = forces.values;
  const auto velocity = state.velocity;
  const double quantum = forces.quantum.value;
  const LimbScale scale = scales.power;
  LimbSums<1> sums;
  Kokkos::parallel_reduce(
      "mechanics::forcePower", rangePolicy(space, mesh.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node, LimbSums<1>& all) {
        if (!m.node_is_owned(node))
          return;
        double power = 0;
        for (int d = 0; d < 3; ++d)
          power += quantum * static_cast<double>(values(node, 3 * kind + d)) * velocity(node, d);
        all.add(0, power, scale);
      },
      PlusReducer<LimbSums<1>>(sums));
  space.fence();
  allReduce(comm, sums);
  return sums.sum[0].value(scale);
}

} // namespace brickwall::mechanics
