// Kinematics and forces at the nodes. All ranks that share a node hold the same bits.
#pragma once

#include "contact/base/fixed_point.hpp"

namespace brickwall::mechanics {

struct NodalState {
  View<double* [3]> displacement; // u^n [node][xyz], length; x = X + u
  View<double* [3]> velocity; // v^{n-1/2} before the kick, v^{n+1/2} after it, length/time
  View<double*> mass; // lumped, summed over ranks
};

// Force kinds of the ledger; each is a group of 3 columns of NodalForces::values. The columns of
// bulk viscosity come last and exist only in runs that use it.
enum ForceKind : int {
  internal_force, // material and hourglass stiffness
  contact_force,
  external_force,
  viscous_force,
  num_force_kinds
};
inline int numForceColumns(bool has_viscosity) {
  return 3 * (has_viscosity ? num_force_kinds : viscous_force);
}

// Fixed-point nodal forces of this rank's elements and faces, in quanta; totals after the
// shared-node sum. Gravity is not included: it is exactly m g at each node.
struct NodalForces {
  View<std::int64_t**> values; // [node][3 * kind + xyz], numForceColumns() columns
  Quantum quantum; // force of one unit
};

} // namespace brickwall::mechanics
