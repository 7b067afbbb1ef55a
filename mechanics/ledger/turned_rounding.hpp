// Rounding of the energy and the angular momentum of bodies with an initial rotation. The
// neo-Hookean energy of a rotation, mu (|H|^2/2 + tr H - ln J), is zero as the sum of terms of the
// order of mu (|H| + |H|^2 + |H|^3), since J - 1 is a cubic polynomial of H. The rounding of these
// terms remains; it is equal in all elements with the same rotation, and not small against the
// energy of a body at rest. The other materials square a strain, whose rounding has an effect of
// second order only.
#pragma once

#include "mechanics/ledger/ledger_sums.hpp"

namespace brickwall::mechanics {

// Raises `scales.noise` to 256 times that rounding, so that its error is below a hundredth, and
// `scales.angular_noise` to the angular momentum of the rotated elements at this kinetic energy,
// since the rounded forces slowly spin a free body. Bodies without displacement raise nothing. The
// bits do not depend on the partition. Collective.
void raiseNoiseFloorForRotation(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                                const View<const double* [3]>& displacement, LedgerScales& scales);

} // namespace brickwall::mechanics
