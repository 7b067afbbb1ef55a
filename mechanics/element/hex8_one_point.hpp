// Total-Lagrangian one-point hexahedron with assumed-strain ("physical") hourglass stiffness (TL-PS),
// in Walsh-Hadamard modes: U = V W(F) + U_h, forces are the exact gradient. Templates on the scalar type.
#pragma once

#include "mechanics/element/hex8_geometry.hpp"
#include "mechanics/element/material.hpp"

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
struct OnePointGeometry {
  static constexpr int gradient_modes = num_modes;
  static constexpr int size = 46; // numbers stored
  Real B[num_modes][3]; // b_m / 8: H_ij = sum_m u_mi B_mj
  Real M[num_hourglass_modes][3]; // h_a . X
  // Rows: local axes (the polar factor of dX/dxi, transposed), each divided by the norm of its column of dX/dxi.
  Real Q[3][3];
  Real thinness[3]; // squares of the other two norms' inverses over that of this one's
  Real volume;
};

// Parallelepiped: b has linear modes only and h_a . X = 0 (gamma = h/8).
struct OnePointBox {
  static constexpr int gradient_modes = 3;
  double B[3][3];
  double Q[3][3];
  double thinness[3];
  double volume;
};

// Parallelepiped whose edges are along the axes of space, in their order: B is diagonal and the local axes are those of
// space. Its forces are those of OnePointBox but for rounding.
struct OnePointBrick {
  static constexpr int gradient_modes = 3;
  double b[3]; // diagonal of B
  double inverse_length[3]; // of the half-edges
  double volume;
};

// Rows of Q do not depend on the numbering of the corners but for order and sign, nor does the energy.
template <class Geometry>
KOKKOS_INLINE_FUNCTION void setFrame(const Mat3& jacobian, Geometry& geometry) {
  const Mat3 r = polarFactor(jacobian);
  double square[3]; // of inverse lengths
  for (int i = 0; i < 3; ++i) {
    const Vec3 column = {jacobian(0, i), jacobian(1, i), jacobian(2, i)};
    const double inverse_length = 1.0 / norm(column);
    square[i] = inverse_length * inverse_length;
    for (int j = 0; j < 3; ++j)
      geometry.Q[i][j] = inverse_length * r(j, i);
  }
  for (int i = 0; i < 3; ++i)
    geometry.thinness[i] = (square[(i + 1) % 3] + square[(i + 2) % 3]) / square[i];
}
KOKKOS_INLINE_FUNCTION OnePointGeometry<double> onePointGeometry(const CornerCoordinates& X) {
  OnePointGeometry<double> geometry;
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
KOKKOS_INLINE_FUNCTION OnePointBox onePointBox(const Mat3& jacobian) {
  OnePointBox box;
  const double det = determinant(jacobian);
  const Mat3 b = inverse(jacobian, det);
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j)
      box.B[k][j] = 0.125 * b(k, j);
  box.volume = 8 * det;
  setFrame(jacobian, box);
  return box;
}
KOKKOS_INLINE_FUNCTION bool isOnePointBrick(const Mat3& jacobian) {
  bool is_brick = true;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      is_brick = is_brick && (i == j ? jacobian(i, j) > 0 : jacobian(i, j) == 0);
  return is_brick;
}
// Needs isOnePointBrick(jacobian).
KOKKOS_INLINE_FUNCTION OnePointBrick onePointBrick(const Mat3& jacobian) {
  OnePointBrick brick;
  brick.volume = 8 * (jacobian(0, 0) * jacobian(1, 1) * jacobian(2, 2));
  for (int k = 0; k < 3; ++k) {
    brick.inverse_length[k] = 1 / jacobian(k, k);
    brick.b[k] = 0.125 * brick.inverse_length[k];
  }
  return brick;
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
template <class Real>
KOKKOS_INLINE_FUNCTION void meanGradient(const Real (&u)[3][num_modes], const OnePointBrick& brick,
                                         Real (&H)[3][3]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      H[i][j] = u[i][j] * brick.b[j];
}

// 8 g_a = 8 sum_I gamma_aI u_I = u_a - H M_a, [a][xyz].
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

// What an element's stiffness adds to its geometry: moduli times -volume/quantum, so that forces come in quanta; those of
// the hourglass part also over 64, since strains are 8 g. Modulus is double where all lanes share it.
template <class Modulus>
struct OnePointStiffness {
  Modulus lambda, mu;
  Modulus bend, bend_cross; // of a pair of bending modes: E/(1 - nu^2)/3, and nu times that
  Modulus twist, twist_own[3]; // mu/3; what each mode has besides the sum of the three
  Modulus fourth; // E/9
  double inverse_factor; // energy = inverse_factor * (energy by these moduli)
};
struct BrickStiffness {
  double lambda, mu;
  double own[3][3]; // [mode a][axis]: of bending on the off-diagonal, of torsion on the diagonal
  double cross[3][3]; // of mode (a, i) with (i, a): bending; symmetric
  double twist[3]; // of modes (i, i) and (j, j), i, j other than the index
  double fourth[3];
  double inverse_factor;
};
template <class Geometry>
struct StiffnessOf;
template <class Real>
struct StiffnessOf<OnePointGeometry<Real>> {
  using type = OnePointStiffness<Real>;
};
template <>
struct StiffnessOf<OnePointBox> {
  using type = OnePointStiffness<double>;
};
template <>
struct StiffnessOf<OnePointBrick> {
  using type = BrickStiffness;
};

// `scale` is 1/quantum.
template <class Geometry>
KOKKOS_INLINE_FUNCTION typename StiffnessOf<Geometry>::type
stiffnessOf(const Geometry& geometry, const ElementModuli& moduli, double scale) {
  typename StiffnessOf<Geometry>::type result;
  const auto factor = -scale * geometry.volume;
  result.lambda = factor * moduli.lambda;
  result.mu = factor * moduli.mu;
  result.bend = factor * (moduli.bending / 32);
  result.bend_cross = factor * (moduli.bending / 32 * moduli.poisson);
  result.twist = factor * (moduli.torsion / 32);
  for (int i = 0; i < 3; ++i)
    result.twist_own[i] = result.twist * (geometry.thinness[i] - 1.0);
  result.fourth = factor * (moduli.fourth / 32);
  result.inverse_factor = -1 / scale;
  return result;
}
KOKKOS_INLINE_FUNCTION BrickStiffness stiffnessOf(const OnePointBrick& brick,
                                                  const ElementModuli& moduli, double scale) {
  BrickStiffness result;
  const double(&l)[3] = brick.inverse_length;
  const double factor = -scale * brick.volume;
  const double bend = factor * (moduli.bending / 32), twist = factor * (moduli.torsion / 32);
  result.lambda = factor * moduli.lambda;
  result.mu = factor * moduli.mu;
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    for (int i = 0; i < 3; ++i) {
      result.own[a][i] = a == i ? twist * (l[b] * l[b] + l[c] * l[c]) : bend * (l[i] * l[i]);
      result.cross[a][i] = bend * moduli.poisson * (l[a] * l[i]);
    }
    result.twist[a] = twist * (l[b] * l[c]);
    result.fourth[a] = factor * (moduli.fourth / 32) * (l[a] * l[a]);
  }
  result.inverse_factor = -1 / scale;
  return result;
}

// s = d(U_h/V)/dq for the corotated hourglass strains q [a][local axis], each over the length of its axis: U_h/V is the sum of
//   bending  E/(1 - nu^2)/6 (p^2 + r^2 + 2 nu p r), (p, r) = (q3x/a, q1z/c), (q2x/a, q1y/b), (q3y/b, q2z/c)
//   torsion  mu/6 (t1^2 + t2^2 + t3^2), t1 = q1x/b + q2y/a, t2 = q2y/c + q3z/b, t3 = q3z/a + q1x/c
//   fourth   E/18 [(q4x/a)^2 + (q4y/b)^2 + (q4z/c)^2]
template <class Real, class Modulus>
KOKKOS_INLINE_FUNCTION void hourglassStress(const Real (&q)[num_hourglass_modes][3],
                                            const OnePointStiffness<Modulus>& k,
                                            Real (&s)[num_hourglass_modes][3]) {
  const Real sum = k.twist * (q[0][0] + q[1][1] + q[2][2]);
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < 3; ++i)
      s[a][i] = a == i ? Real(k.twist_own[a] * q[a][a] + sum)
                       : Real(k.bend * q[a][i] + k.bend_cross * q[i][a]);
  for (int i = 0; i < 3; ++i)
    s[3][i] = k.fourth * q[3][i];
}
// A = F Q^T, so that q_a = Q F^T g_a = A^T g_a.
template <class Real, class Geometry>
KOKKOS_INLINE_FUNCTION void deformedAxes(const Real (&H)[3][3], const Geometry& geometry,
                                         Real (&A)[3][3]) {
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      A[i][k] = geometry.Q[k][i] + (H[i][0] * geometry.Q[k][0] + H[i][1] * geometry.Q[k][1] +
                                    H[i][2] * geometry.Q[k][2]);
}
// Forces on the modes of one axis i of space, from row i of dU/dF = P, of T = sum_a g_a (x) s_a and of r_a = A s_a:
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

// What an element tells besides its forces.
template <class Real>
struct OnePointPoint {
  Real J;
  Real material_energy, hourglass_energy; // only when asked for
};

// What the forces on one axis of space are made of.
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
// take(i, force) for the axes i of space, with i constant in each call: loops would keep arrays out of registers.
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

// Calls take(axis, force) for one axis of space after the other, as soon as its forces are known: by mode, minus dU/du_m in
// quanta. What takes them at once leaves registers to the other axes.
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
// All at once.
template <MaterialModel model, VolumeChange volume = VolumeChange::any, class Real, class Geometry,
          class Stiffness>
KOKKOS_FORCEINLINE_FUNCTION void
onePointForces(const Real (&u)[3][num_modes], const Geometry& geometry, const Stiffness& stiffness,
               bool with_energy, OnePointForces<Real>& out) {
  onePointForcesByAxis<model, volume>(u, geometry, stiffness, with_energy, StoreForces<Real>{out},
                                      out);
}

} // namespace brickwall::mechanics
