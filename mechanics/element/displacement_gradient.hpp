// The displacement gradient at the centre of an element, for diagnostics. Point-wise.
#pragma once

#include "mechanics/element/hex8_geometry.hpp"

namespace brickwall::mechanics {

// H = du/dX.
KOKKOS_INLINE_FUNCTION Mat3 displacementGradient(const CornerCoordinates& X,
                                                 const CornerCoordinates& u) {
  double X_modes[3][num_modes], u_modes[3][num_modes];
  coordinateModes(X, X_modes);
  coordinateModes(u, u_modes);
  const Mat3 jacobian = centreJacobian(X_modes);
  return centreJacobian(u_modes) * inverse(jacobian, determinant(jacobian));
}

} // namespace brickwall::mechanics
