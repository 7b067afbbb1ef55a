#include "mechanics/step/undo_step.hpp"

#include "mechanics/step/acceleration.hpp"

namespace brickwall::miniapp {

void undoKickAndDrift(const exec_space& space, const mechanics::HexMesh& mesh,
                      const mechanics::BoundaryConditions& boundary,
                      const mechanics::TimeSpan& drift, double dt_kick, double dt_drift,
                      const mechanics::NodalForces& forces, const mechanics::NodalState& state) {
  const mechanics::BoundaryConditions::DuringStep in_drift = boundary.during(drift);
  const auto motion =
      nodalMotion(forces.values, state.mass, boundary.motion(), forces.quantum.value, boundary);
  const auto u = state.displacement, v = state.velocity;
  Kokkos::parallel_for(
      "miniapp::undoKickAndDrift", rangePolicy(space, mesh.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node) {
        for (int d = 0; d < 3; ++d) {
          v(node, d) = motion.isPrescribed(node, d)
                           ? in_drift.velocity[in_drift.motion(node, d)][d]
                           : motion.velocityBefore(node, d, v(node, d), dt_kick);
          u(node, d) -= dt_drift * v(node, d);
        }
      });
  space.fence();
}

} // namespace brickwall::miniapp
