// Acceleration of a node by the summed forces and mass-proportional damping, and the inverse of a
// kick, for host and device.
#pragma once

#include "contact/base/vec3.hpp"
#include "mechanics/loads/boundary_conditions.hpp"
#include "mechanics/mesh/hex_mesh.hpp"
#include "mechanics/mesh/nodal_state.hpp"

namespace brickwall::mechanics {

// Views may be those of the device or their host copies.
template <class Values, class Masses, class Motions>
struct NodalMotion {
  Values values; // NodalForces::values after the shared-node sum
  Masses mass;
  Motions motion; // BoundaryConditions::DuringStep::motion
  KindFlags acts;
  double quantum, damping;
  Vec3 gravity;
  bool any_prescribed;

  KOKKOS_INLINE_FUNCTION bool isPrescribed(std::int64_t node, int d) const {
    return any_prescribed && motion(node, d);
  }
  // Acceleration by all forces and gravity, without damping; 0 where the motion is prescribed.
  KOKKOS_INLINE_FUNCTION double acceleration(std::int64_t node, int d) const {
    if (isPrescribed(node, d))
      return 0;
    std::int64_t force = 0;
    for (int kind = 0; kind < num_force_kinds; ++kind) // a constant: see NodalForces::acts
      if (3 * kind < static_cast<int>(values.extent(1)) && acts[kind])
        force += values(node, 3 * kind + d);
    const double m = mass(node); // 0 without elements
    return (m > 0 ? static_cast<double>(force) * quantum / m : 0.0) + gravity[d];
  }
  // Asks for the operands of acceleration().
  KOKKOS_FORCEINLINE_FUNCTION void prefetchOperands(std::int64_t node) const {
    for (int kind = 0; kind < num_force_kinds; ++kind)
      if (3 * kind < static_cast<int>(values.extent(1)) && acts[kind])
        for (int d = 0; d < 3; ++d)
          prefetch(&values(node, 3 * kind + d));
    prefetch(&mass(node));
  }
  // (v+ - v)/dt of a kick from v, including damping; v is read only with damping.
  template <class Velocities>
  KOKKOS_INLINE_FUNCTION double acceleration(std::int64_t node, int d, const Velocities& v,
                                             double dt) const {
    const double free = acceleration(node, d);
    if (!(damping > 0) || isPrescribed(node, d))
      return free;
    return (free - damping * v(node, d)) / (1 + 0.5 * dt * damping);
  }
  // The velocity from which a kick over dt leads to v. Requires dt * damping < 2.
  KOKKOS_INLINE_FUNCTION double velocityBefore(std::int64_t node, int d, double v,
                                               double dt) const {
    const double before = v - dt * acceleration(node, d);
    if (!(damping > 0) || isPrescribed(node, d))
      return before;
    const double half = 0.5 * dt * damping;
    return (before + half * v) / (1 - half);
  }
};

// `values` are forces.values or their host copy.
template <class Values, class Masses, class Motions>
NodalMotion<Values, Masses, Motions> nodalMotion(const NodalForces& forces, const Values& values,
                                                 const Masses& mass, const Motions& motion,
                                                 const BoundaryConditions& boundary) {
  return {values,
          mass,
          motion,
          forces.acts,
          forces.quantum.value,
          boundary.massDamping(),
          boundary.gravity(),
          boundary.any()};
}

// Undoes a kick and the preceding drift, up to rounding, so that the last good state can be written
// after a failed step. v^{n+1/2} -> v^{n-1/2} with the forces and the step `dt_kick` of the kick,
// then u^n -> u^{n-1} over the drift from t^{n-1} to t^n of length `dt_drift`. Prescribed
// components get the velocity that they had in this drift.
void undoKickAndDrift(const exec_space& space, const HexMesh& mesh,
                      const BoundaryConditions& boundary, const TimeSpan& drift, double dt_kick,
                      double dt_drift, const NodalForces& forces, const NodalState& state);

} // namespace brickwall::mechanics
