// Kinematics and forces at the nodes. Every sharer of a node holds the same bits.
#pragma once

#include "contact/base/fixed_point.hpp"

namespace brickwall::mechanics {

struct NodalState {
  View<double* [3]> displacement; // u^n [node][xyz], length; x = X + u
  View<double* [3]> velocity; // v^{n-1/2} before the kick, v^{n+1/2} after it, length/time
  View<double*> mass; // lumped, summed over ranks
};

// Force kinds of the ledger; each is a group of 3 columns of NodalForces::values. Those of bulk viscosity are the last and
// are there only in runs that have it.
enum ForceKind : int {
  internal_force, // of material and hourglass stiffness
  contact_force,
  external_force,
  viscous_force,
  num_force_kinds
};
inline int numForceColumns(bool has_viscosity) {
  return 3 * (has_viscosity ? num_force_kinds : viscous_force);
}

// Fixed-point nodal forces of this rank's elements and faces, in quanta; after the shared-node sum, totals.
// Gravity is not here: it is exactly m g at each node.
struct NodalForces {
  View<std::int64_t**> values; // [node][3 * kind + xyz], numForceColumns() of them
  Quantum quantum; // force of one unit
};

} // namespace brickwall::mechanics
