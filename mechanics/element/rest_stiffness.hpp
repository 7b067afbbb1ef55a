// Forces K u of one hexahedron for small displacements from rest, for both kinds of element, by
// Walsh-Hadamard modes. All materials have the same moduli at rest.
#pragma once

#include "mechanics/element/hex8_full.hpp"
#include "mechanics/element/hex8_one_point.hpp"

namespace brickwall::mechanics {

// dU/du_m of the one-point element, linear in u: onePointForces linearised at F = I.
KOKKOS_INLINE_FUNCTION void restForces(const double (&u)[3][num_modes],
                                       const OnePointGeometry<double>& geometry,
                                       const Material& material, double (&forces)[3][num_modes]) {
  // moduli times the volume
  const auto stiffness = stiffnessOf(geometry, ElementModuli::of(material), -1.0);
  double H[3][3];
  meanGradient(u, geometry, H);
  StressPoint<double> point;
  linearElastic(H, stiffness.lambda, stiffness.mu, false, point);

  double g[num_hourglass_modes][3], q[num_hourglass_modes][3], s[num_hourglass_modes][3];
  hourglassStrains(u, geometry, H, g);
  for (int a = 0; a < num_hourglass_modes; ++a)
    for (int k = 0; k < 3; ++k)
      q[a][k] =
          geometry.Q[k][0] * g[a][0] + geometry.Q[k][1] * g[a][1] + geometry.Q[k][2] * g[a][2];
  hourglassStress(q, stiffness, s);

  // r_a = Q^T s_a. g_a contains -H M_a, so the mean gradient takes its share of r.
  double r[num_hourglass_modes][3];
  for (int a = 0; a < num_hourglass_modes; ++a)
    for (int i = 0; i < 3; ++i)
      r[a][i] =
          geometry.Q[0][i] * s[a][0] + geometry.Q[1][i] * s[a][1] + geometry.Q[2][i] * s[a][2];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      point.P[i][j] -= r[0][i] * geometry.M[0][j] + r[1][i] * geometry.M[1][j] +
                       r[2][i] * geometry.M[2][j] + r[3][i] * geometry.M[3][j];
  for (int i = 0; i < 3; ++i)
    for (int m = 0; m < num_modes; ++m) {
      double sum = point.P[i][0] * geometry.B[m][0] + point.P[i][1] * geometry.B[m][1] +
                   point.P[i][2] * geometry.B[m][2];
      if (m >= 3)
        sum += r[m >= 3 ? m - 3 : 0][i];
      forces[i][m] = sum;
    }
}

// dU/du_m of the fully integrated element.
KOKKOS_INLINE_FUNCTION void restForces(const double (&u)[3][num_modes],
                                       const FullGeometry<double>& geometry,
                                       const Material& material, double (&forces)[3][num_modes]) {
  FullForces<double> out;
  fullForces<MaterialModel::linear>(u, geometry, material.lambda(), material.mu(), -1.0, false,
                                    out);
  for (int i = 0; i < 3; ++i)
    for (int m = 0; m < num_modes; ++m)
      forces[i][m] = out.material[i][m];
}

} // namespace brickwall::mechanics
