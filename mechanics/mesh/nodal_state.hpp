// Kinematics and forces at the nodes. All ranks that share a node hold the same bits.
#pragma once

#include "contact/base/fixed_point.hpp"

#include <cstdint>

namespace brickwall::mechanics {

struct NodalState {
  View<double* [3]> displacement; // u^n [node][xyz], length; x = X + u
  View<double* [3]> velocity; // v^{n-1/2} before the kick, v^{n+1/2} after it, length/time
  View<double*> mass; // summed over ranks
};

// The displacement after the next drift, of length `dt`; without rows it is not asked for.
struct DriftAhead {
  View<double* [3]> displacement; // [node][xyz], length
  double dt = 0;
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
using KindFlags = Kokkos::Array<bool, num_force_kinds>;

// [node][3 * kind + xyz]. Each column is contiguous, so that kernels read only the kinds that they
// need, and packs of consecutive nodes at once.
using ForceColumns = Kokkos::View<std::int64_t**, Kokkos::LayoutLeft, memory_space>;

// Fixed-point nodal forces of this rank's elements and faces, in quanta; totals after the
// shared-node sum. Gravity is not included: it is exactly m g at each node.
struct NodalForces {
  ForceColumns values; // numForceColumns() columns
  Quantum quantum; // force of one unit
  // false: the columns of this kind are zero. A kernel with an index that is not known when it is
  // compiled copies its arguments in each thread.
  KindFlags acts = {{true, true, true, true}};
  View<const unsigned char*> may_touch = {}; // [node] 0: no contact acts on it; empty: not known

  KOKKOS_INLINE_FUNCTION bool hasKind(int kind) const {
    return 3 * kind < static_cast<int>(values.extent(1));
  }
};

} // namespace brickwall::mechanics
