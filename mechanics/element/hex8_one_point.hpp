// One-point hexahedron with physical stabilisation: total Lagrangian, one evaluation of the
// material at the mean gradient, and an assumed-strain hourglass stiffness from the elastic moduli;
// theory.md, equations (2), (3) and (10) to (12). U = V W(F) + U_h, and the forces are its exact
// gradient. In Walsh-Hadamard modes; templates on the scalar type.
#pragma once

#include "mechanics/element/hex8_one_point_stiffness.hpp"

namespace brickwall::mechanics {

// Mean displacement gradient, H_ij = sum_m u_mi B_mj with u [xyz][mode]; equation (2).
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
template <class Real>
KOKKOS_INLINE_FUNCTION void meanGradient(const Real (&u)[3][num_modes], const OnePointBrick& brick,
                                         Real (&H)[3][3]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      H[i][j] = u[i][j] * brick.b[j];
}

// Hourglass strains, 8 g_a = 8 sum_I gamma_aI u_I = u_a - H M_a, [a][xyz]; equation (3).
template <class Real>
KOKKOS_INLINE_FUNCTION void
hourglassStrains(const Real (&u)[3][num_modes], const OnePointGeometry<Real>& geometry,
                 const Real (&H)[3][3], Real (&g)[num_hourglass_modes][3]) {
  for (int a = 0; a < num_hourglass_modes; ++a)
    for (int i = 0; i < 3; ++i)
      g[a][i] = u[i][3 + a] - (H[i][0] * geometry.M[a][0] + H[i][1] * geometry.M[a][1] +
                               H[i][2] * geometry.M[a][2]);
}
template <class Real, class Box>
KOKKOS_INLINE_FUNCTION void hourglassStrains(const Real (&u)[3][num_modes], const Box&,
                                             const Real (&)[3][3],
                                             Real (&g)[num_hourglass_modes][3]) {
  for (int a = 0; a < num_hourglass_modes; ++a)
    for (int i = 0; i < 3; ++i)
      g[a][i] = u[i][3 + a];
}

// A = F Q^T, so that the corotated hourglass strains are q_a = Q F^T g_a = A^T g_a.
template <class Real, class Geometry>
KOKKOS_INLINE_FUNCTION void deformedAxes(const Real (&H)[3][3], const Geometry& geometry,
                                         Real (&A)[3][3]) {
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      A[i][k] = geometry.Q[k][i] + (H[i][0] * geometry.Q[k][0] + H[i][1] * geometry.Q[k][1] +
                                    H[i][2] * geometry.Q[k][2]);
}
// Modal forces on axis i of space from row i of dU/dF = P, of T = sum_a g_a (x) s_a and of r_a = A
// s_a, equation (12):
// f_m = (P + T Q - sum_a r_a (x) M_a) B_m + r_m.
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void
modeForces(const Real (&P)[3], const Real (&T)[3], const Real (&r)[num_hourglass_modes],
           const OnePointGeometry<Real>& geometry, Real (&force)[num_modes]) {
  Real D[3];
  for (int j = 0; j < 3; ++j)
    D[j] = P[j] + (T[0] * geometry.Q[0][j] + T[1] * geometry.Q[1][j] + T[2] * geometry.Q[2][j]);
  for (int j = 0; j < 3; ++j)
    D[j] -= r[0] * geometry.M[0][j] + r[1] * geometry.M[1][j] +
            (r[2] * geometry.M[2][j] + r[3] * geometry.M[3][j]);
  for (int m = 0; m < num_modes; ++m) {
    const Real share = D[0] * geometry.B[m][0] + D[1] * geometry.B[m][1] + D[2] * geometry.B[m][2];
    force[m] = m >= 3 ? Real(share + r[m >= 3 ? m - 3 : 0]) : share;
  }
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void modeForces(const Real (&P)[3], const Real (&T)[3],
                                            const Real (&r)[num_hourglass_modes],
                                            const OnePointBox& box, Real (&force)[num_modes]) {
  Real D[3];
  for (int j = 0; j < 3; ++j)
    D[j] = P[j] + (T[0] * box.Q[0][j] + T[1] * box.Q[1][j] + T[2] * box.Q[2][j]);
  for (int m = 0; m < 3; ++m)
    force[m] = D[0] * box.B[m][0] + D[1] * box.B[m][1] + D[2] * box.B[m][2];
  for (int a = 0; a < num_hourglass_modes; ++a)
    force[3 + a] = r[a];
}

// Results of an element besides its forces.
template <class Real>
struct OnePointPoint {
  Real J;
  Real material_energy, hourglass_energy; // set only if with_energy
};

// Terms of the forces on one axis of space.
template <class Real, class Geometry>
struct OnePointParts {
  const Geometry& geometry;
  Real P[3][3], A[3][3];
  Real g[num_hourglass_modes][3], s[num_hourglass_modes][3];

  KOKKOS_FORCEINLINE_FUNCTION void forces(int i, Real (&force)[num_modes]) const {
    Real r[num_hourglass_modes], T[3];
    for (int a = 0; a < num_hourglass_modes; ++a)
      r[a] = A[i][0] * s[a][0] + A[i][1] * s[a][1] + A[i][2] * s[a][2];
    for (int k = 0; k < 3; ++k)
      T[k] = g[0][i] * s[0][k] + g[1][i] * s[1][k] + (g[2][i] * s[2][k] + g[3][i] * s[3][k]);
    modeForces(P[i], T, r, geometry, force);
  }
};
// Calls take(i, force) for the axes i of space. i is constant in each call, because loops would
// keep the arrays out of registers.
template <class Real, class Parts, class Take>
KOKKOS_FORCEINLINE_FUNCTION void takeForces(const Parts& parts, const Take& take) {
  Real x[num_modes], y[num_modes], z[num_modes];
  parts.forces(0, x);
  take(0, x);
  parts.forces(1, y);
  take(1, y);
  parts.forces(2, z);
  take(2, z);
}

// Calls take(axis, force) for each axis of space as soon as its modal forces, -dU/du_m in quanta,
// are known. A caller that consumes them at once leaves the registers to the other axes.
template <MaterialModel model, VolumeChange volume, class Real, class Geometry, class Stiffness,
          class Take>
KOKKOS_FORCEINLINE_FUNCTION void onePointForcesByAxis(const Real (&u)[3][num_modes],
                                                      const Geometry& geometry,
                                                      const Stiffness& stiffness, bool with_energy,
                                                      const Take& take, OnePointPoint<Real>& out) {
  Real H[3][3], q[num_hourglass_modes][3];
  meanGradient(u, geometry, H);
  StressPoint<Real> point;
  evaluateMaterial<model, volume>(H, stiffness.lambda, stiffness.mu, with_energy, point);
  out.J = point.J;

  OnePointParts<Real, Geometry> parts{geometry, {}, {}, {}, {}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      parts.P[i][j] = point.P[i][j];
  hourglassStrains(u, geometry, H, parts.g);
  deformedAxes(H, geometry, parts.A);
  for (int a = 0; a < num_hourglass_modes; ++a)
    for (int k = 0; k < 3; ++k)
      q[a][k] = parts.A[0][k] * parts.g[a][0] + parts.A[1][k] * parts.g[a][1] +
                parts.A[2][k] * parts.g[a][2];
  hourglassStress(q, stiffness, parts.s);
  if (with_energy) {
    out.material_energy = stiffness.inverse_factor * point.W;
    Real product = q[0][0] * parts.s[0][0];
    for (int k = 1; k < 3 * num_hourglass_modes; ++k)
      product += q[k / 3][k % 3] * parts.s[k / 3][k % 3];
    out.hourglass_energy = (0.5 * stiffness.inverse_factor) * product;
  }
  takeForces<Real>(parts, take);
}

template <class Real>
struct BrickParts {
  const OnePointBrick& brick;
  const Real (&u)[3][num_modes];
  Real P[3][3], F[3][3];
  Real s[num_hourglass_modes][3];

  KOKKOS_FORCEINLINE_FUNCTION void forces(int i, Real (&force)[num_modes]) const {
    for (int k = 0; k < 3; ++k)
      force[k] = brick.b[k] * (P[i][k] + s[3][k] * u[i][6] + s[0][k] * u[i][3] + s[1][k] * u[i][4] +
                               s[2][k] * u[i][5]);
    for (int a = 0; a < num_hourglass_modes; ++a)
      force[3 + a] = s[a][0] * F[i][0] + s[a][1] * F[i][1] + s[a][2] * F[i][2];
  }
};
template <MaterialModel model, VolumeChange volume, class Real, class Take>
KOKKOS_FORCEINLINE_FUNCTION void onePointForcesByAxis(const Real (&u)[3][num_modes],
                                                      const OnePointBrick& brick,
                                                      const BrickStiffness& k, bool with_energy,
                                                      const Take& take, OnePointPoint<Real>& out) {
  Real H[3][3];
  meanGradient(u, brick, H);
  StressPoint<Real> point;
  evaluateMaterial<model, volume>(H, k.lambda, k.mu, with_energy, point);
  out.J = point.J;
  BrickParts<Real> parts{brick, u, {}, {}, {}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      parts.P[i][j] = point.P[i][j];
      parts.F[i][j] = i == j ? Real(H[i][j] + 1.0) : H[i][j];
    }
  Real q[num_hourglass_modes][3];
  for (int a = 0; a < num_hourglass_modes; ++a)
    for (int j = 0; j < 3; ++j)
      q[a][j] =
          parts.F[0][j] * u[0][3 + a] + parts.F[1][j] * u[1][3 + a] + parts.F[2][j] * u[2][3 + a];
  Real(&s)[num_hourglass_modes][3] = parts.s;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, l = (i + 2) % 3;
    s[i][i] = k.own[i][i] * q[i][i] + (k.twist[l] * q[j][j] + k.twist[j] * q[l][l]);
    s[i][j] = k.own[i][j] * q[i][j] + k.cross[i][j] * q[j][i];
    s[i][l] = k.own[i][l] * q[i][l] + k.cross[i][l] * q[l][i];
    s[3][i] = k.fourth[i] * q[3][i];
  }
  if (with_energy) {
    Real product = q[3][0] * s[3][0] + q[3][1] * s[3][1] + q[3][2] * s[3][2];
    for (int a = 0; a < 3; ++a)
      product += q[a][0] * s[a][0] + q[a][1] * s[a][1] + q[a][2] * s[a][2];
    out.material_energy = k.inverse_factor * point.W;
    out.hourglass_energy = (0.5 * k.inverse_factor) * product;
  }
  takeForces<Real>(parts, take);
}

template <class Real>
struct OnePointForces : OnePointPoint<Real> {
  Real force[3][num_modes]; // [xyz][mode]
};
template <class Real>
struct StoreForces {
  OnePointForces<Real>& forces;
  KOKKOS_FORCEINLINE_FUNCTION void operator()(int axis, const Real (&force)[num_modes]) const {
    for (int m = 0; m < num_modes; ++m)
      forces.force[axis][m] = force[m];
  }
};
// Stores the forces on all axes.
template <MaterialModel model, VolumeChange volume = VolumeChange::any, class Real, class Geometry,
          class Stiffness>
KOKKOS_FORCEINLINE_FUNCTION void
onePointForces(const Real (&u)[3][num_modes], const Geometry& geometry, const Stiffness& stiffness,
               bool with_energy, OnePointForces<Real>& out) {
  onePointForcesByAxis<model, volume>(u, geometry, stiffness, with_energy, StoreForces<Real>{out},
                                      out);
}

} // namespace brickwall::mechanics
