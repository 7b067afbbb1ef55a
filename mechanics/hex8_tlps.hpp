// Total-Lagrangian one-point hexahedron with assumed-strain ("physical") hourglass stiffness (TL-PS),
// in Walsh-Hadamard modes: U = V W(F) + U_h, forces are the exact gradient. Templates on the scalar type.
#pragma once

#include "mechanics/hex8_geometry.hpp"
#include "mechanics/material.hpp"

namespace brickwall::mechanics {

// Moduli of one material as the element uses them.
struct ElementModuli {
  double lambda = 0, mu = 0, poisson = 0;
  double bending = 0; // E / (6 (1 - nu^2))
  double torsion = 0; // mu / 6
  double fourth = 0; // E / 18
  KOKKOS_INLINE_FUNCTION static ElementModuli of(const Material& m) {
    return {m.lambda(), m.mu(),       m.poisson, m.youngs / (6 * (1 - m.poisson * m.poisson)),
            m.mu() / 6, m.youngs / 18};
  }
};

// General hexahedron.
template <class Real>
struct TlpsGeometry {
  static constexpr int gradient_modes = num_modes;
  static constexpr int size = 46; // numbers stored
  Real B[num_modes][3]; // b_m / 8: H_ij = sum_m u_mi B_mj
  Real M[num_hourglass_modes][3]; // h_a . X
  Real Q[3][3]; // rows: local axes, the polar factor of dX/dxi, transposed
  Real inverse_length[3]; // 1 / norms of the columns of dX/dxi
  Real volume;
};

// Parallelepiped: b has linear modes only and h_a . X = 0 (gamma = h/8).
struct TlpsBox {
  static constexpr int gradient_modes = 3;
  static constexpr int size = 22;
  double B[3][3];
  double Q[3][3];
  double inverse_length[3];
  double volume;
};

// Rows of Q do not depend on the numbering of the corners but for order and sign, nor does the energy.
template <class Geometry>
KOKKOS_INLINE_FUNCTION void setFrame(const Mat3& jacobian, Geometry& geometry) {
  const Mat3 r = polarFactor(jacobian);
  for (int i = 0; i < 3; ++i) {
    const Vec3 column = {jacobian(0, i), jacobian(1, i), jacobian(2, i)};
    geometry.inverse_length[i] = 1.0 / norm(column);
    for (int j = 0; j < 3; ++j)
      geometry.Q[i][j] = r(j, i);
  }
}
KOKKOS_INLINE_FUNCTION TlpsGeometry<double> tlpsGeometry(const CornerCoordinates& X) {
  TlpsGeometry<double> geometry;
  double modes[3][num_modes];
  coordinateModes(X, modes);
  geometry.volume = hexVolume(X).volume;
  meanGradientModes(modes, geometry.volume, geometry.B);
  for (int m = 0; m < num_modes; ++m)
    for (int j = 0; j < 3; ++j)
      geometry.B[m][j] *= 0.125;
  for (int a = 0; a < num_hourglass_modes; ++a)
    for (int j = 0; j < 3; ++j)
      geometry.M[a][j] = modes[j][3 + a];
  setFrame(centreJacobian(modes), geometry);
  return geometry;
}
KOKKOS_INLINE_FUNCTION TlpsBox tlpsBox(const Mat3& jacobian) {
  TlpsBox box;
  const double det = determinant(jacobian);
  const Mat3 b = inverse(jacobian, det);
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j)
      box.B[k][j] = 0.125 * b(k, j);
  box.volume = 8 * det;
  setFrame(jacobian, box);
  return box;
}

// H_ij = sum_m u_mi B_mj, u [xyz][mode].
template <class Real, class Geometry>
KOKKOS_INLINE_FUNCTION void meanGradient(const Real (&u)[3][num_modes], const Geometry& geometry,
                                         Real (&H)[3][3]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      Real sum = u[i][0] * geometry.B[0][j];
      for (int m = 1; m < Geometry::gradient_modes; ++m)
        sum += u[i][m] * geometry.B[m][j];
      H[i][j] = sum;
    }
}

// g_a = sum_I gamma_aI u_I = (u_a - H M_a)/8, g [a][xyz].
template <class Real>
KOKKOS_INLINE_FUNCTION void
hourglassStrains(const Real (&u)[3][num_modes], const TlpsGeometry<Real>& geometry,
                 const Real (&H)[3][3], Real (&g)[num_hourglass_modes][3]) {
  for (int a = 0; a < num_hourglass_modes; ++a)
    for (int i = 0; i < 3; ++i)
      g[a][i] = 0.125 * (u[i][3 + a] - (H[i][0] * geometry.M[a][0] + H[i][1] * geometry.M[a][1] +
                                        H[i][2] * geometry.M[a][2]));
}
template <class Real>
KOKKOS_INLINE_FUNCTION void hourglassStrains(const Real (&u)[3][num_modes], const TlpsBox&,
                                             const Real (&)[3][3],
                                             Real (&g)[num_hourglass_modes][3]) {
  for (int a = 0; a < num_hourglass_modes; ++a)
    for (int i = 0; i < 3; ++i)
      g[a][i] = 0.125 * u[i][3 + a];
}

// s = d(U_h/V)/dq for the corotated hourglass strains q [a][local axis]; U_h/V = (1/2) sum q s. `l` = 1/(a, b, c).
template <class Real, class Length>
KOKKOS_INLINE_FUNCTION void hourglassStress(const Real (&q)[num_hourglass_modes][3],
                                            const Length (&l)[3], const ElementModuli& moduli,
                                            Real (&s)[num_hourglass_modes][3]) {
  const double bend = 2 * moduli.bending, twist = 2 * moduli.torsion, nu = moduli.poisson;
  // Bending: modes (a, i) and (b, j) of the pairs (q3x, q1z), (q2x, q1y), (q3y, q2z).
  const Real p0 = q[2][0] * l[0], r0 = q[0][2] * l[2];
  const Real p1 = q[1][0] * l[0], r1 = q[0][1] * l[1];
  const Real p2 = q[2][1] * l[1], r2 = q[1][2] * l[2];
  s[2][0] = (bend * l[0]) * (p0 + nu * r0), s[0][2] = (bend * l[2]) * (r0 + nu * p0);
  s[1][0] = (bend * l[0]) * (p1 + nu * r1), s[0][1] = (bend * l[1]) * (r1 + nu * p1);
  s[2][1] = (bend * l[1]) * (p2 + nu * r2), s[1][2] = (bend * l[2]) * (r2 + nu * p2);
  const Real t1 = q[0][0] * l[1] + q[1][1] * l[0];
  const Real t2 = q[1][1] * l[2] + q[2][2] * l[1];
  const Real t3 = q[2][2] * l[0] + q[0][0] * l[2];
  s[0][0] = twist * (t1 * l[1] + t3 * l[2]);
  s[1][1] = twist * (t1 * l[0] + t2 * l[2]);
  s[2][2] = twist * (t2 * l[1] + t3 * l[0]);
  for (int i = 0; i < 3; ++i)
    s[3][i] = (2 * moduli.fourth * l[i] * l[i]) * q[3][i];
}

// Forces by modes (minus dU/du_m), multiplied by `scale` (1/quantum), and energies.
template <class Real, class Geometry>
struct TlpsForces {
  Real material[3][Geometry::gradient_modes]; // [xyz][mode]
  Real hourglass[3][num_modes];
  Real J;
  Real material_energy, hourglass_energy; // only when asked for
};

template <MaterialModel model, class Real, class Geometry>
KOKKOS_INLINE_FUNCTION void tlpsForces(const Real (&u)[3][num_modes], const Geometry& geometry,
                                       const ElementModuli& moduli, double scale, bool with_energy,
                                       TlpsForces<Real, Geometry>& out) {
  Real H[3][3];
  meanGradient(u, geometry, H);
  StressPoint<Real> point;
  evaluateMaterial<model>(H, moduli.lambda, moduli.mu, with_energy, point);
  out.J = point.J;
  const auto factor = -scale * geometry.volume;
  for (int i = 0; i < 3; ++i)
    for (int m = 0; m < Geometry::gradient_modes; ++m)
      out.material[i][m] =
          factor * (point.P[i][0] * geometry.B[m][0] + point.P[i][1] * geometry.B[m][1] +
                    point.P[i][2] * geometry.B[m][2]);

  // q_a = Q F^T g_a = A^T g_a with A = F Q^T
  Real g[num_hourglass_modes][3], A[3][3], q[num_hourglass_modes][3], s[num_hourglass_modes][3];
  hourglassStrains(u, geometry, H, g);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      A[i][k] = geometry.Q[k][i] + (H[i][0] * geometry.Q[k][0] + H[i][1] * geometry.Q[k][1] +
                                    H[i][2] * geometry.Q[k][2]);
  for (int a = 0; a < num_hourglass_modes; ++a)
    for (int k = 0; k < 3; ++k)
      q[a][k] = A[0][k] * g[a][0] + A[1][k] * g[a][1] + A[2][k] * g[a][2];
  hourglassStress(q, geometry.inverse_length, moduli, s);

  // dU_h/dF = [sum_a g_a (x) s_a] Q less (1/8) sum_a r_a (x) M_a; r_a = A s_a goes to the modes themselves
  Real r[num_hourglass_modes][3], T[3][3], D[3][3];
  for (int a = 0; a < num_hourglass_modes; ++a)
    for (int i = 0; i < 3; ++i)
      r[a][i] = A[i][0] * s[a][0] + A[i][1] * s[a][1] + A[i][2] * s[a][2];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      T[i][k] = g[0][i] * s[0][k] + g[1][i] * s[1][k] + (g[2][i] * s[2][k] + g[3][i] * s[3][k]);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      D[i][j] =
          T[i][0] * geometry.Q[0][j] + T[i][1] * geometry.Q[1][j] + T[i][2] * geometry.Q[2][j];
      if constexpr (Geometry::gradient_modes == num_modes)
        D[i][j] -= 0.125 * (r[0][i] * geometry.M[0][j] + r[1][i] * geometry.M[1][j] +
                            (r[2][i] * geometry.M[2][j] + r[3][i] * geometry.M[3][j]));
    }
  for (int i = 0; i < 3; ++i)
    for (int m = 0; m < num_modes; ++m) {
      Real sum;
      if (m >= 3)
        sum = 0.125 * r[m >= 3 ? m - 3 : 0][i];
      if (m < Geometry::gradient_modes) {
        const int n = m < Geometry::gradient_modes ? m : 0;
        const Real share =
            D[i][0] * geometry.B[n][0] + D[i][1] * geometry.B[n][1] + D[i][2] * geometry.B[n][2];
        sum = m >= 3 ? Real(sum + share) : share;
      }
      out.hourglass[i][m] = factor * sum;
    }
  if (with_energy) {
    out.material_energy = geometry.volume * point.W;
    Real product = q[0][0] * s[0][0];
    for (int k = 1; k < 3 * num_hourglass_modes; ++k)
      product += q[k / 3][k % 3] * s[k / 3][k % 3];
    out.hourglass_energy = (0.5 * geometry.volume) * product;
  }
}

} // namespace brickwall::mechanics
