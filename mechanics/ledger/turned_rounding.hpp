// What rounding does to the energy and the angular momentum of bodies that start turned. The neo-Hookean energy of a rotation,
// mu (|H|^2/2 + tr H - ln J), is 0 as the sum of terms of the order of mu (|H| + |H|^2 + |H|^3), J - 1 being a cubic of H: what is left is
// their rounding, the same in all elements that are turned alike, and not small against the energy of a body at rest. The other
// materials square a strain, whose own rounding then counts to the second order only.
#pragma once

#include "mechanics/ledger/ledger_sums.hpp"

namespace brickwall::mechanics {

// Raises `scales.noise` to 256 times that rounding, whose errors are then below a hundredth, and `scales.angular_noise` to the angular
// momentum of the turned elements at this kinetic energy: forces that are rounded likewise set a free body spinning, slowly. Bodies
// that are not displaced raise nothing. The same bits on any layout. Collective.
void raiseNoiseFloorForRotation(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                                const View<const double* [3]>& displacement, LedgerScales& scales);

} // namespace brickwall::mechanics
