// Acceleration of a node from the summed forces, for host and device.
#pragma once

#include "contact/base/vec3.hpp"
#include "mechanics/nodal_state.hpp"

namespace brickwall::miniapp {

// Component d of the acceleration of a node by all forces and gravity; 0 where the motion is prescribed. `values` are
// NodalForces::values (or their host copy) after the shared-node sum, `motion` as of BoundaryConditions::AtTime.
template <class Values, class Motion>
KOKKOS_INLINE_FUNCTION double accelerationOf(const Values& values, double quantum, double mass,
                                             const Vec3& gravity, bool any_prescribed,
                                             const Motion& motion, std::int64_t node, int d) {
  if (any_prescribed && motion(node, d))
    return 0;
  std::int64_t force = 0;
  for (int kind = 0; kind < mechanics::num_force_kinds; ++kind)
    force += values(node, 3 * kind + d);
  return static_cast<double>(force) * quantum / mass + gravity[d];
}

} // namespace brickwall::miniapp
