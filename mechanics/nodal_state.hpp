// Kinematics and forces at the nodes. Every sharer of a node holds the same bits.
#pragma once

#include "contact/base/fixed_point.hpp"

namespace brickwall::mechanics {

struct NodalState {
  View<double* [3]> displacement; // u^n [node][xyz], length; x = X + u
  View<double* [3]> velocity; // v^{n-1/2} before the kick, v^{n+1/2} after it, length/time
  View<double*> mass; // lumped, summed over ranks
};

// Force kinds of the ledger; each is a group of 3 columns of NodalForces::values.
enum ForceKind : int {
  material_force,
  hourglass_force,
  contact_force,
  external_force,
  num_force_kinds
};

// Fixed-point nodal forces of this rank's elements and faces, in quanta; after the shared-node sum, totals.
// Internal force is material_force + hourglass_force. Gravity is not here: it is exactly m g at each node.
struct NodalForces {
  View<std::int64_t**> values; // [node][3 * kind + xyz]
  Quantum quantum; // force of one unit
};

} // namespace brickwall::mechanics
