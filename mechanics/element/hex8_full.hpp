// Fully integrated (2x2x2 Gauss) total-Lagrangian hexahedron in Walsh-Hadamard modes; theory.md,
// equation (13). It has no hourglass energy. It is stiff in bending and near incompressibility and
// serves for comparison. Templates on the scalar type.
#pragma once

#include "mechanics/element/hex8_geometry.hpp"
#include "mechanics/element/material.hpp"

namespace brickwall::mechanics {

// Modes of the reference coordinates, X_m = sum_I h_mI X_I.
template <class Real>
struct FullGeometry {
  static constexpr int gradient_modes = num_modes;
  static constexpr int size = 3 * num_modes;
  Real X[3][num_modes]; // [xyz][mode]
};

template <class Real>
struct FullForces {
  Real material[3][num_modes]; // -dU/du_m times scale, [xyz][mode]
  Real J; // smallest over the integration points
  Real material_energy; // set only if with_energy
};

// Local gradient of a field at a point, times 8: sum_m field_m grad psi_m.
template <class Real>
KOKKOS_INLINE_FUNCTION void localGradient(const Real (&field)[3][num_modes], const double (&xi)[3],
                                          Real (&gradient)[3][3]) {
  const double x = xi[0], y = xi[1], z = xi[2];
  for (int i = 0; i < 3; ++i) {
    gradient[i][0] = field[i][0] + z * field[i][4] + y * field[i][5] + (y * z) * field[i][6];
    gradient[i][1] = field[i][1] + z * field[i][3] + x * field[i][5] + (z * x) * field[i][6];
    gradient[i][2] = field[i][2] + y * field[i][3] + x * field[i][4] + (x * y) * field[i][6];
  }
}

// H at a point, C = 64 cof(dX/dxi) and D = 512 det(dX/dxi).
template <class Real>
KOKKOS_INLINE_FUNCTION void pointGradient(const Real (&u)[3][num_modes],
                                          const FullGeometry<Real>& geometry, const double (&xi)[3],
                                          Real (&H)[3][3], Real (&C)[3][3], Real& D) {
  Real du[3][3], dX[3][3];
  localGradient(u, xi, du);
  localGradient(geometry.X, xi, dX);
  cofactors(dX, C);
  D = dX[0][0] * C[0][0] + dX[0][1] * C[0][1] + dX[0][2] * C[0][2];
  const Real inverse_D = 1.0 / D;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      H[i][j] = inverse_D * (du[i][0] * C[j][0] + du[i][1] * C[j][1] + du[i][2] * C[j][2]);
}

// Adds the modal forces of the stress P at a point, times `factor`; C is that of pointGradient.
template <class Real>
KOKKOS_INLINE_FUNCTION void addPointForces(const Real (&P)[3][3], const Real (&C)[3][3],
                                           const double (&xi)[3], double factor,
                                           Real (&modes)[3][num_modes]) {
  const double x = xi[0], y = xi[1], z = xi[2];
  for (int i = 0; i < 3; ++i) {
    Real f[3];
    for (int k = 0; k < 3; ++k)
      f[k] = factor * (P[i][0] * C[0][k] + P[i][1] * C[1][k] + P[i][2] * C[2][k]);
    modes[i][0] += f[0];
    modes[i][1] += f[1];
    modes[i][2] += f[2];
    modes[i][3] += z * f[1] + y * f[2];
    modes[i][4] += z * f[0] + x * f[2];
    modes[i][5] += y * f[0] + x * f[1];
    modes[i][6] += (y * z) * f[0] + (z * x) * f[1] + (x * y) * f[2];
  }
}

template <MaterialModel model, class Real>
KOKKOS_INLINE_FUNCTION void fullForces(const Real (&u)[3][num_modes],
                                       const FullGeometry<Real>& geometry, double lambda, double mu,
                                       double scale, bool with_energy, FullForces<Real>& out) {
  for (int i = 0; i < 3; ++i)
    for (int m = 0; m < num_modes; ++m)
      out.material[i][m] = Real(0.0);
  out.J = Real(HUGE_VAL);
  out.material_energy = Real(0.0);
  const double factor = -scale / 512;
  for (int p = 0; p < 8; ++p) {
    double xi[3];
    gaussPoint(p, xi);
    Real H[3][3], C[3][3], D;
    pointGradient(u, geometry, xi, H, C, D);
    StressPoint<Real> point;
    evaluateMaterial<model>(H, lambda, mu, with_energy, point);
    out.J = minOrNan(point.J, out.J);
    addPointForces(point.P, C, xi, factor, out.material);
    if (with_energy)
      out.material_energy += (1.0 / 512) * (D * point.W);
  }
}

} // namespace brickwall::mechanics
