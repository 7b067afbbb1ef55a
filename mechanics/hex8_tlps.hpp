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
  // Rows: local axes (the polar factor of dX/dxi, transposed), each divided by the norm of its column of dX/dxi.
  Real Q[3][3];
  Real thinness[3]; // squares of the other two norms' inverses over that of this one's
  Real volume;
};

// Parallelepiped: b has linear modes only and h_a . X = 0 (gamma = h/8).
struct TlpsBox {
  static constexpr int gradient_modes = 3;
  double B[3][3];
  double Q[3][3];
  double thinness[3];
  double volume;
};

// Parallelepiped whose edges are along the axes of space, in their order: B is diagonal and the local axes are those of
// space. Its forces are those of TlpsBox but for rounding.
struct TlpsBrick {
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
KOKKOS_INLINE_FUNCTION bool isTlpsBrick(const Mat3& jacobian) {
  bool is_brick = true;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      is_brick = is_brick && (i == j ? jacobian(i, j) > 0 : jacobian(i, j) == 0);
  return is_brick;
}
// Needs isTlpsBrick(jacobian).
KOKKOS_INLINE_FUNCTION TlpsBrick tlpsBrick(const Mat3& jacobian) {
  TlpsBrick brick;
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
KOKKOS_INLINE_FUNCTION void meanGradient(const Real (&u)[3][num_modes], const TlpsBrick& brick,
                                         Real (&H)[3][3]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      H[i][j] = u[i][j] * brick.b[j];
}

// 8 g_a = 8 sum_I gamma_aI u_I = u_a - H M_a, [a][xyz].
template <class Real>
KOKKOS_INLINE_FUNCTION void
hourglassStrains(const Real (&u)[3][num_modes], const TlpsGeometry<Real>& geometry,
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
struct TlpsStiffness {
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
struct StiffnessOf<TlpsGeometry<Real>> {
  using type = TlpsStiffness<Real>;
};
template <>
struct StiffnessOf<TlpsBox> {
  using type = TlpsStiffness<double>;
};
template <>
struct StiffnessOf<TlpsBrick> {
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
KOKKOS_INLINE_FUNCTION BrickStiffness stiffnessOf(const TlpsBrick& brick,
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
                                            const TlpsStiffness<Modulus>& k,
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
// Forces by modes from dU/dF = P, T = sum_a g_a (x) s_a and r_a = A s_a: f_m = (P + T Q - sum_a r_a (x) M_a) B_m + r_m.
template <class Real>
KOKKOS_INLINE_FUNCTION void
modeForces(const Real (&P)[3][3], const Real (&T)[3][3], const Real (&r)[num_hourglass_modes][3],
           const TlpsGeometry<Real>& geometry, Real (&force)[3][num_modes]) {
  for (int i = 0; i < 3; ++i) {
    Real D[3];
    for (int j = 0; j < 3; ++j)
      D[j] = P[i][j] +
             (T[i][0] * geometry.Q[0][j] + T[i][1] * geometry.Q[1][j] + T[i][2] * geometry.Q[2][j]);
    for (int j = 0; j < 3; ++j)
      D[j] -= r[0][i] * geometry.M[0][j] + r[1][i] * geometry.M[1][j] +
              (r[2][i] * geometry.M[2][j] + r[3][i] * geometry.M[3][j]);
    for (int m = 0; m < num_modes; ++m) {
      const Real share =
          D[0] * geometry.B[m][0] + D[1] * geometry.B[m][1] + D[2] * geometry.B[m][2];
      force[i][m] = m >= 3 ? Real(share + r[m >= 3 ? m - 3 : 0][i]) : share;
    }
  }
}
template <class Real>
KOKKOS_INLINE_FUNCTION void modeForces(const Real (&P)[3][3], const Real (&T)[3][3],
                                       const Real (&r)[num_hourglass_modes][3], const TlpsBox& box,
                                       Real (&force)[3][num_modes]) {
  for (int i = 0; i < 3; ++i) {
    Real D[3];
    for (int j = 0; j < 3; ++j)
      D[j] = P[i][j] + (T[i][0] * box.Q[0][j] + T[i][1] * box.Q[1][j] + T[i][2] * box.Q[2][j]);
    for (int m = 0; m < 3; ++m)
      force[i][m] = D[0] * box.B[m][0] + D[1] * box.B[m][1] + D[2] * box.B[m][2];
    for (int a = 0; a < num_hourglass_modes; ++a)
      force[i][3 + a] = r[a][i];
  }
}
template <class Real>
struct TlpsForces {
  Real force[3][num_modes]; // [xyz][mode], minus dU/du_m in quanta
  Real J;
  Real material_energy, hourglass_energy; // only when asked for
};

template <MaterialModel model, VolumeChange volume = VolumeChange::any, class Real, class Geometry,
          class Stiffness>
KOKKOS_FORCEINLINE_FUNCTION void tlpsForces(const Real (&u)[3][num_modes], const Geometry& geometry,
                                            const Stiffness& stiffness, bool with_energy,
                                            TlpsForces<Real>& out) {
  Real H[3][3];
  meanGradient(u, geometry, H);
  StressPoint<Real> point;
  evaluateMaterial<model, volume>(H, stiffness.lambda, stiffness.mu, with_energy, point);
  out.J = point.J;

  Real g[num_hourglass_modes][3], A[3][3], q[num_hourglass_modes][3], s[num_hourglass_modes][3];
  hourglassStrains(u, geometry, H, g);
  deformedAxes(H, geometry, A);
  for (int a = 0; a < num_hourglass_modes; ++a)
    for (int k = 0; k < 3; ++k)
      q[a][k] = A[0][k] * g[a][0] + A[1][k] * g[a][1] + A[2][k] * g[a][2];
  hourglassStress(q, stiffness, s);

  Real r[num_hourglass_modes][3], T[3][3];
  for (int a = 0; a < num_hourglass_modes; ++a)
    for (int i = 0; i < 3; ++i)
      r[a][i] = A[i][0] * s[a][0] + A[i][1] * s[a][1] + A[i][2] * s[a][2];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      T[i][k] = g[0][i] * s[0][k] + g[1][i] * s[1][k] + (g[2][i] * s[2][k] + g[3][i] * s[3][k]);
  modeForces(point.P, T, r, geometry, out.force);
  if (with_energy) {
    out.material_energy = stiffness.inverse_factor * point.W;
    Real product = q[0][0] * s[0][0];
    for (int k = 1; k < 3 * num_hourglass_modes; ++k)
      product += q[k / 3][k % 3] * s[k / 3][k % 3];
    out.hourglass_energy = (0.5 * stiffness.inverse_factor) * product;
  }
}

// Three numbers for x, y, z.
template <class Real>
struct Triple {
  Real x, y, z;
  KOKKOS_FORCEINLINE_FUNCTION Triple& operator+=(const Triple& b) {
    x += b.x, y += b.y, z += b.z;
    return *this;
  }
};
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Triple<Real> operator+(const Triple<Real>& a, const Triple<Real>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class Factor, class Real>
KOKKOS_FORCEINLINE_FUNCTION Triple<Real> operator*(const Factor& s, const Triple<Real>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Real dot(const Triple<Real>& a, const Triple<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void setMode(TlpsForces<Real>& forces, int m, const Triple<Real>& f) {
  forces.force[0][m] = f.x, forces.force[1][m] = f.y, forces.force[2][m] = f.z;
}

// Of a brick, spelled out and ordered for few numbers at a time: the compiler keeps them in registers.
template <MaterialModel model, VolumeChange volume = VolumeChange::any, class Real>
KOKKOS_FORCEINLINE_FUNCTION void tlpsForces(const Real (&u)[3][num_modes], const TlpsBrick& brick,
                                            const BrickStiffness& k, bool with_energy,
                                            TlpsForces<Real>& out) {
  const double b0 = brick.b[0], b1 = brick.b[1], b2 = brick.b[2];
  const Real H[3][3] = {{u[0][0] * b0, u[0][1] * b1, u[0][2] * b2},
                        {u[1][0] * b0, u[1][1] * b1, u[1][2] * b2},
                        {u[2][0] * b0, u[2][1] * b1, u[2][2] * b2}};
  StressPoint<Real> point;
  evaluateMaterial<model, volume>(H, k.lambda, k.mu, with_energy, point);
  out.J = point.J;
  const Triple<Real> A0 = {H[0][0] + 1.0, H[1][0], H[2][0]}; // columns of F
  const Triple<Real> A1 = {H[0][1], H[1][1] + 1.0, H[2][1]};
  const Triple<Real> A2 = {H[0][2], H[1][2], H[2][2] + 1.0};
  const auto strain = [&](int m) { return Triple<Real>{u[0][m], u[1][m], u[2][m]}; };

  // The fourth mode stands alone.
  const Triple<Real> g3 = strain(6);
  const Real q30 = dot(A0, g3), q31 = dot(A1, g3), q32 = dot(A2, g3);
  const Real s30 = k.fourth[0] * q30, s31 = k.fourth[1] * q31, s32 = k.fourth[2] * q32;
  setMode(out, 6, s30 * A0 + s31 * A1 + s32 * A2);
  Real product = q30 * s30 + q31 * s31 + q32 * s32;
  // columns of P + sum of g_a (x) s_a
  Triple<Real> T0 = Triple<Real>{point.P[0][0], point.P[1][0], point.P[2][0]} + s30 * g3;
  Triple<Real> T1 = Triple<Real>{point.P[0][1], point.P[1][1], point.P[2][1]} + s31 * g3;
  Triple<Real> T2 = Triple<Real>{point.P[0][2], point.P[1][2], point.P[2][2]} + s32 * g3;

  const Triple<Real> g0 = strain(3), g1 = strain(4), g2 = strain(5);
  const Real q00 = dot(A0, g0), q01 = dot(A1, g0), q02 = dot(A2, g0);
  const Real q10 = dot(A0, g1), q11 = dot(A1, g1), q12 = dot(A2, g1);
  const Real q20 = dot(A0, g2), q21 = dot(A1, g2), q22 = dot(A2, g2);

  const Real s00 = k.own[0][0] * q00 + (k.twist[2] * q11 + k.twist[1] * q22);
  const Real s01 = k.own[0][1] * q01 + k.cross[0][1] * q10;
  const Real s02 = k.own[0][2] * q02 + k.cross[0][2] * q20;
  setMode(out, 3, s00 * A0 + s01 * A1 + s02 * A2);
  product += q00 * s00 + q01 * s01 + q02 * s02;
  T0 += s00 * g0, T1 += s01 * g0, T2 += s02 * g0;

  const Real s10 = k.own[1][0] * q10 + k.cross[0][1] * q01;
  const Real s11 = k.own[1][1] * q11 + (k.twist[0] * q22 + k.twist[2] * q00);
  const Real s12 = k.own[1][2] * q12 + k.cross[1][2] * q21;
  setMode(out, 4, s10 * A0 + s11 * A1 + s12 * A2);
  product += q10 * s10 + q11 * s11 + q12 * s12;
  T0 += s10 * g1, T1 += s11 * g1, T2 += s12 * g1;

  const Real s20 = k.own[2][0] * q20 + k.cross[0][2] * q02;
  const Real s21 = k.own[2][1] * q21 + k.cross[1][2] * q12;
  const Real s22 = k.own[2][2] * q22 + (k.twist[1] * q00 + k.twist[0] * q11);
  setMode(out, 5, s20 * A0 + s21 * A1 + s22 * A2);
  product += q20 * s20 + q21 * s21 + q22 * s22;
  T0 += s20 * g2, T1 += s21 * g2, T2 += s22 * g2;

  setMode(out, 0, b0 * T0);
  setMode(out, 1, b1 * T1);
  setMode(out, 2, b2 * T2);
  if (with_energy) {
    out.material_energy = k.inverse_factor * point.W;
    out.hourglass_energy = (0.5 * k.inverse_factor) * product;
  }
}

} // namespace brickwall::mechanics
