#include "mechanics/step/nodal_motion.hpp"

namespace brickwall::mechanics {

void undoKickAndDrift(const exec_space& space, const HexMesh& mesh,
                      const BoundaryConditions& boundary, const TimeSpan& drift, double dt_kick,
                      double dt_drift, const NodalForces& forces, const NodalState& state) {
  const BoundaryConditions::DuringStep in_drift = boundary.during(drift);
  const auto motion = nodalMotion(forces, forces.values, state.mass, boundary.motion(), boundary);
  const auto u = state.displacement, v = state.velocity;
  Kokkos::parallel_for(
      "mechanics::undoKickAndDrift::nodes", rangePolicy(space, mesh.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node) {
        for (int d = 0; d < 3; ++d) {
          v(node, d) = motion.isPrescribed(node, d)
                           ? in_drift.velocityOf(in_drift.motion(node, d))[d]
                           : motion.velocityBefore(node, d, v(node, d), dt_kick);
          u(node, d) -= dt_drift * v(node, d);
        }
      });
  space.fence();
}

} // namespace brickwall::mechanics
