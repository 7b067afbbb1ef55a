// Measures of a stress [xx yy zz xy yz zx].
#pragma once

#include "mechanics/element/symmetric_eigenvalue.hpp"

namespace brickwall::mechanics {

// sqrt(3/2 s:s) with the deviator s.
KOKKOS_INLINE_FUNCTION double vonMises(const double (&sigma)[6]) {
  const double xy = sigma[0] - sigma[1], yz = sigma[1] - sigma[2], zx = sigma[2] - sigma[0];
  const double shear = sigma[3] * sigma[3] + sigma[4] * sigma[4] + sigma[5] * sigma[5];
  return std::sqrt(0.5 * (xy * xy + yz * yz + zx * zx) + 3 * shear);
}

// The largest first.
KOKKOS_INLINE_FUNCTION void principalStresses(const double (&sigma)[6], double (&principal)[3]) {
  const double matrix[3][3] = {{sigma[0], sigma[3], sigma[5]},
                               {sigma[3], sigma[1], sigma[4]},
                               {sigma[5], sigma[4], sigma[2]}};
  double values[3];
  symmetricEigenvalues(matrix, values);
  principal[0] = maxOf(values[0], maxOf(values[1], values[2]));
  principal[2] = minOf(values[0], minOf(values[1], values[2]));
  principal[1] = maxOf(minOf(values[0], values[1]), minOf(maxOf(values[0], values[1]), values[2]));
}

} // namespace brickwall::mechanics
