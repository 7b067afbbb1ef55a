// Bulk viscosity: a pressure against fast compression that spreads a shock over a few elements
// (quadratic term: von Neumann and Richtmyer 1950; linear term: Landshoff 1955); theory.md,
// equations (14) and (15). With sigma += q I,
//   q = rho l tr D (b1 c_d + b2^2 l |tr D| H(-tr D)),  P = J q F^-T,
// tr D = F^-T : dF/dt, rho = rho_0/J, c_d the dilatational wave speed, and l twice the shortest
// half-edge of the element at rest, so that thin elements are not damped beyond what their time
// step allows. Linear materials use F = I and J = 1. The velocity is lagged, v^{n-1/2}, and the
// work is dissipated. Point-wise templates on the scalar type.
#pragma once

#include "mechanics/element/hex8_full.hpp"
#include "mechanics/element/hex8_one_point.hpp"

namespace brickwall::mechanics {

struct BulkViscosity {
  double linear = 0; // b1
  double quadratic = 0; // b2
  KOKKOS_INLINE_FUNCTION bool any() const { return linear > 0 || quadratic > 0; }
};

// Viscous moduli of one material.
struct ViscousModuli {
  double linear = 0; // rho_0 b1 c_d
  double quadratic = 0; // rho_0 b2^2
  double inverse_speed = 0; // 1/c_d
  KOKKOS_INLINE_FUNCTION static ViscousModuli of(const Material& m, const BulkViscosity& b) {
    const double speed = m.dilatationalSpeed();
    return {m.density * b.linear * speed, m.density * b.quadratic * b.quadratic, 1 / speed};
  }
};

template <class Real>
struct ViscousStress {
  Real P[3][3]; // first Piola-Kirchhoff
  Real rate; // l |tr D|/c_d of compression, 0 in expansion
};

// Stress from the gradients of displacement and velocity, H and dH/dt.
template <MaterialModel model, class Real>
KOKKOS_INLINE_FUNCTION void viscousStress(const Real (&H)[3][3], const Real (&H_dot)[3][3],
                                          const Real& length, const ViscousModuli& moduli,
                                          ViscousStress<Real>& out) {
  Real F[3][3], G[3][3], trace; // G = F^-T
  if (model == MaterialModel::linear) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        G[i][j] = Real(i == j ? 1.0 : 0.0);
    trace = H_dot[0][0] + H_dot[1][1] + H_dot[2][2];
  } else {
    deformationGradient(H, F);
    cofactors(F, G);
    const Real inverse_J = 1.0 / (1.0 + volumeChange(H));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        G[i][j] = inverse_J * G[i][j];
    trace = G[0][0] * H_dot[0][0];
    for (int k = 1; k < 9; ++k)
      trace += G[k / 3][k % 3] * H_dot[k / 3][k % 3];
  }
  const Real compression = length * positivePart(-trace);
  const Real J_q = (length * trace) * (moduli.linear + moduli.quadratic * compression);
  out.rate = moduli.inverse_speed * compression;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      out.P[i][j] = J_q * G[i][j];
}

// The element length l is twice the smallest norm of the columns of dX/dxi at the centre. The rows
// of Q are unit vectors divided by these norms.
template <class Real>
KOKKOS_INLINE_FUNCTION Real lengthByFrame(const Real (&Q)[3][3]) {
  Real square[3]; // squares of inverse norms
  for (int k = 0; k < 3; ++k)
    square[k] = Q[k][0] * Q[k][0] + Q[k][1] * Q[k][1] + Q[k][2] * Q[k][2];
  return 2.0 / squareRoot(maxMagnitude(square[0], maxMagnitude(square[1], square[2])));
}
template <class Real>
KOKKOS_INLINE_FUNCTION Real elementLength(const OnePointGeometry<Real>& geometry) {
  return lengthByFrame(geometry.Q);
}
KOKKOS_INLINE_FUNCTION double elementLength(const OnePointBox& box) {
  return lengthByFrame(box.Q);
}
KOKKOS_INLINE_FUNCTION double elementLength(const OnePointBrick& brick) {
  const auto& l = brick.inverse_length;
  return 2.0 / maxMagnitude(l[0], maxMagnitude(l[1], l[2]));
}
template <class Real>
KOKKOS_INLINE_FUNCTION Real elementLength(const FullGeometry<Real>& geometry) {
  const auto& X = geometry.X; // 8 times dX/dxi at the centre
  Real square[3];
  for (int k = 0; k < 3; ++k)
    square[k] = X[0][k] * X[0][k] + X[1][k] * X[1][k] + X[2][k] * X[2][k];
  return 0.25 * squareRoot(minOrNan(square[0], minOrNan(square[1], square[2])));
}

// Modal forces multiplied by `scale` (1/quantum).
template <class Real, int modes>
struct ViscousForces {
  Real force[3][modes]; // [xyz][mode]
  Real rate; // largest over the integration points
};

// P_i . B_m
template <class Real, class Geometry>
KOKKOS_INLINE_FUNCTION Real gradientForce(const Real (&P)[3], const Geometry& geometry, int m) {
  return P[0] * geometry.B[m][0] + P[1] * geometry.B[m][1] + P[2] * geometry.B[m][2];
}
template <class Real>
KOKKOS_INLINE_FUNCTION Real gradientForce(const Real (&P)[3], const OnePointBrick& brick, int m) {
  return P[m] * brick.b[m];
}

template <MaterialModel model, class Real, class Geometry>
KOKKOS_INLINE_FUNCTION void viscousForces(const Real (&u)[3][num_modes],
                                          const Real (&v)[3][num_modes], const Geometry& geometry,
                                          const ViscousModuli& moduli, double scale,
                                          ViscousForces<Real, Geometry::gradient_modes>& out) {
  Real H[3][3], H_dot[3][3];
  meanGradient(u, geometry, H);
  meanGradient(v, geometry, H_dot);
  ViscousStress<Real> point;
  viscousStress<model>(H, H_dot, Real(elementLength(geometry)), moduli, point);
  out.rate = point.rate;
  const auto factor = -scale * geometry.volume;
  for (int i = 0; i < 3; ++i)
    for (int m = 0; m < Geometry::gradient_modes; ++m)
      out.force[i][m] = factor * gradientForce(point.P[i], geometry, m);
}

// Full integration evaluates the viscous stress at each of the 2x2x2 points.
template <MaterialModel model, class Real>
KOKKOS_INLINE_FUNCTION void
viscousForces(const Real (&u)[3][num_modes], const Real (&v)[3][num_modes],
              const FullGeometry<Real>& geometry, const ViscousModuli& moduli, double scale,
              ViscousForces<Real, num_modes>& out) {
  for (int i = 0; i < 3; ++i)
    for (int m = 0; m < num_modes; ++m)
      out.force[i][m] = Real(0.0);
  out.rate = Real(0.0);
  const Real length = elementLength(geometry);
  for (int p = 0; p < 8; ++p) {
    double xi[3];
    gaussPoint(p, xi);
    Real H[3][3], H_dot[3][3], C[3][3], D;
    pointGradient(v, geometry, xi, H_dot, C, D);
    pointGradient(u, geometry, xi, H, C, D);
    ViscousStress<Real> point;
    viscousStress<model>(H, H_dot, length, moduli, point);
    out.rate = maxMagnitude(point.rate, out.rate);
    addPointForces(point.P, C, xi, -scale / 512, out.force);
  }
}

} // namespace brickwall::mechanics
