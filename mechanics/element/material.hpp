// Elastic materials: St. Venant-Kirchhoff, neo-Hookean and small-strain linear; theory.md,
// equations (4) to (9). Point-wise templates on the scalar type (double or Pack). They take the
// displacement gradient H = du/dX, since F = I + H formed from positions would lose the digits of
// small strains to cancellation.
#pragma once

#include "contact/base/pack.hpp"
#include "contact/base/portable_math.hpp"

#include <cmath>

namespace brickwall::mechanics {

enum class MaterialModel { neo_hookean, svk, linear };

struct Material {
  MaterialModel model = MaterialModel::neo_hookean;
  double density = 0; // reference mass per volume
  double youngs = 0; // Young's modulus, pressure
  double poisson = 0; // Poisson's ratio
  KOKKOS_INLINE_FUNCTION double lambda() const {
    return youngs * poisson / ((1 + poisson) * (1 - 2 * poisson));
  }
  KOKKOS_INLINE_FUNCTION double mu() const { return youngs / (2 * (1 + poisson)); }
  // Speed c_d of compression waves at small strain, length/time.
  KOKKOS_INLINE_FUNCTION double dilatationalSpeed() const {
    return std::sqrt((lambda() + 2 * mu()) / density);
  }
};

// ln(1 + d) = 2 artanh(s) with s = d/(2 + d), t = s^2. For |d| <= 1/16 five terms of the series are
// used; the first neglected term is at most half an ulp of the sum. The terms are paired to shorten
// the chain of dependent operations. Beyond that portableLog1p is used. The arithmetic is the same
// on every back end.
constexpr double log_series_reach = 0.0625;
template <class Real>
KOKKOS_INLINE_FUNCTION Real logSeries(const Real& s, const Real& t) {
  // t^2 has no name: nvcc accepts no variable of a pack type in a host-device function.
  return s * ((2.0 + t * (2.0 / 3)) + (t * t) * ((2.0 / 5 + t * (2.0 / 7)) + (t * t) * (2.0 / 9)));
}
// The same with s = d/(2 + d) given.
KOKKOS_INLINE_FUNCTION double logOnePlus(double d, double s) {
  return std::fabs(d) <= log_series_reach ? logSeries(s, s * s) : portableLog1p(d);
}
template <int W>
inline PackOf<W> logOnePlus(const PackOf<W>& d, const PackOf<W>& s) {
  PackOf<W> result = logSeries(s, PackOf<W>(s * s));
  if (anyBeyond(d, log_series_reach))
    for (int lane = 0; lane < W; ++lane)
      if (!(std::fabs(d.v[lane]) <= log_series_reach))
        result.v[lane] = portableLog1p(d.v[lane]);
  return result;
}
template <class Real>
KOKKOS_INLINE_FUNCTION Real logOnePlus(const Real& d) {
  return logOnePlus(d, Real(d / (2.0 + d)));
}

// Whether det F is arbitrary or known to be within small_volume_change of 1, in which case the
// lanes of a pack need no tests.
enum class VolumeChange { any, small };
template <MaterialModel model>
constexpr double small_volume_change =
    model == MaterialModel::neo_hookean ? 0.999 * log_series_reach : 1.0;

// Cofactors of F = I + H, so that F^-T = cofactor/J.
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void cofactors(const Real (&F)[3][3], Real (&c)[3][3]) {
  c[0][0] = F[1][1] * F[2][2] - F[1][2] * F[2][1];
  c[0][1] = F[1][2] * F[2][0] - F[1][0] * F[2][2];
  c[0][2] = F[1][0] * F[2][1] - F[1][1] * F[2][0];
  c[1][0] = F[2][1] * F[0][2] - F[2][2] * F[0][1];
  c[1][1] = F[2][2] * F[0][0] - F[2][0] * F[0][2];
  c[1][2] = F[2][0] * F[0][1] - F[2][1] * F[0][0];
  c[2][0] = F[0][1] * F[1][2] - F[0][2] * F[1][1];
  c[2][1] = F[0][2] * F[1][0] - F[0][0] * F[1][2];
  c[2][2] = F[0][0] * F[1][1] - F[0][1] * F[1][0];
}

// J - 1 from the invariants of H.
template <class Real>
KOKKOS_INLINE_FUNCTION Real volumeChange(const Real (&H)[3][3]) {
  Real c[3][3];
  cofactors(H, c);
  return (H[0][0] + H[1][1] + H[2][2]) + (c[0][0] + c[1][1] + c[2][2]) +
         (H[0][0] * c[0][0] + H[0][1] * c[0][1] + H[0][2] * c[0][2]);
}

template <class Real>
KOKKOS_INLINE_FUNCTION void deformationGradient(const Real (&H)[3][3], Real (&F)[3][3]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      F[i][j] = i == j ? H[i][j] + 1.0 : H[i][j];
}

// Energy density, stress and J at one point.
template <class Real>
struct StressPoint {
  Real P[3][3]; // first Piola-Kirchhoff, dW/dH
  Real J; // det F; 1 for the linear material, for which no inversion is defined
  Real W; // energy per reference volume; set only if with_W
};

// Neo-Hookean material, equations (6) and (7): W = mu/2 (tr C - 3) - mu ln J + lambda/2 (ln J)^2
// and P = mu (F - F^-T) + lambda ln J F^-T. With C = cof H, t = tr H, e = tr C + det H = J - 1 - t
// and cof F = (1 + t) I - H^T + C, the stress without cancellation at small strain is
//   P = mu H + (p - r) (H^T - C) + (p e + r (1 + t)) I,  p = mu/J, r = lambda ln J/J.
// The moduli are double, or Real where they differ between lanes.
template <VolumeChange volume = VolumeChange::any, class Real, class Modulus>
KOKKOS_FORCEINLINE_FUNCTION void neoHookean(const Real (&H)[3][3], const Modulus& lambda,
                                            const Modulus& mu, bool with_W,
                                            StressPoint<Real>& out) {
  Real C[3][3];
  cofactors(H, C);
  const Real t = H[0][0] + H[1][1] + H[2][2];
  const Real e =
      (C[0][0] + C[1][1] + C[2][2]) + (H[0][0] * C[0][0] + H[0][1] * C[0][1] + H[0][2] * C[0][2]);
  const Real d = t + e;
  out.J = 1.0 + d;
  const Real two_plus_d = 2.0 + d; // one division yields both 1/J and d/(2 + d)
  const Real inverse = 1.0 / (two_plus_d * out.J);
  const Real inverse_J = two_plus_d * inverse;
  const Real s = (d * out.J) * inverse;
  const Real log_J = volume == VolumeChange::any ? logOnePlus(d, s) : logSeries(s, Real(s * s));
  const Real p = mu * inverse_J, r = (lambda * log_J) * inverse_J;
  const Real difference = p - r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      out.P[i][j] = mu * H[i][j] + difference * (H[j][i] - C[i][j]);
  const Real q = p * e + (r + r * t);
  out.P[0][0] += q, out.P[1][1] += q, out.P[2][2] += q;
  if (with_W) {
    Real square = H[0][0] * H[0][0];
    for (int k = 1; k < 9; ++k)
      square += H[k / 3][k % 3] * H[k / 3][k % 3];
    out.W = mu * (0.5 * square + (t - log_J)) + (0.5 * lambda) * (log_J * log_J);
  }
}

// St. Venant-Kirchhoff material, equation (5): W = lambda/2 (tr E)^2 + mu E:E, P = F S.
template <class Real, class Modulus>
KOKKOS_INLINE_FUNCTION void saintVenantKirchhoff(const Real (&H)[3][3], const Modulus& lambda,
                                                 const Modulus& mu, bool with_W,
                                                 StressPoint<Real>& out) {
  Real F[3][3], E2[3][3], S[3][3]; // E2 = 2 E
  deformationGradient(H, F);
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) {
      E2[i][j] = H[i][j] + H[j][i] + (H[0][i] * H[0][j] + H[1][i] * H[1][j] + H[2][i] * H[2][j]);
      S[i][j] = mu * E2[i][j];
    }
  const Real trace = E2[0][0] + E2[1][1] + E2[2][2];
  const Real p = (0.5 * lambda) * trace;
  S[0][0] += p, S[1][1] += p, S[2][2] += p;
  S[1][0] = S[0][1], S[2][0] = S[0][2], S[2][1] = S[1][2];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      out.P[i][j] = F[i][0] * S[0][j] + F[i][1] * S[1][j] + F[i][2] * S[2][j];
  out.J = 1.0 + volumeChange(H);
  if (with_W) {
    const Real square = E2[0][0] * E2[0][0] + E2[1][1] * E2[1][1] + E2[2][2] * E2[2][2] +
                        2.0 * (E2[0][1] * E2[0][1] + E2[0][2] * E2[0][2] + E2[1][2] * E2[1][2]);
    out.W = (0.125 * lambda) * (trace * trace) + (0.25 * mu) * square;
  }
}

// Linear material at small strain, equation (4): W = lambda/2 (tr e)^2 + mu e:e, P = dW/dH.
template <class Real, class Modulus>
KOKKOS_INLINE_FUNCTION void linearElastic(const Real (&H)[3][3], const Modulus& lambda,
                                          const Modulus& mu, bool with_W, StressPoint<Real>& out) {
  const Real trace = H[0][0] + H[1][1] + H[2][2];
  const Real p = lambda * trace;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      out.P[i][j] = mu * (H[i][j] + H[j][i]);
  out.P[0][0] += p, out.P[1][1] += p, out.P[2][2] += p;
  out.J = Real(1.0);
  if (with_W) {
    Real product = out.P[0][0] * H[0][0];
    for (int k = 1; k < 9; ++k)
      product += out.P[k / 3][k % 3] * H[k / 3][k % 3];
    out.W = 0.5 * product;
  }
}

template <MaterialModel model, VolumeChange volume = VolumeChange::any, class Real, class Modulus>
KOKKOS_FORCEINLINE_FUNCTION void evaluateMaterial(const Real (&H)[3][3], const Modulus& lambda,
                                                  const Modulus& mu, bool with_W,
                                                  StressPoint<Real>& out) {
  if (model == MaterialModel::neo_hookean)
    neoHookean<volume>(H, lambda, mu, with_W, out);
  else if (model == MaterialModel::svk)
    saintVenantKirchhoff(H, lambda, mu, with_W, out);
  else
    linearElastic(H, lambda, mu, with_W, out);
}

// Cauchy stress sigma = P F^T/J in the order xx yy zz xy yz zx, equation (9). For the linear
// material it is P itself.
KOKKOS_INLINE_FUNCTION void cauchyStress(const double (&H)[3][3], const Material& material,
                                         double (&sigma)[6]) {
  StressPoint<double> point;
  double F[3][3];
  const double zero[3][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  deformationGradient(H, F);
  if (material.model == MaterialModel::neo_hookean)
    neoHookean(H, material.lambda(), material.mu(), false, point);
  else if (material.model == MaterialModel::svk)
    saintVenantKirchhoff(H, material.lambda(), material.mu(), false, point);
  else {
    linearElastic(H, material.lambda(), material.mu(), false, point);
    deformationGradient(zero, F);
  }
  const int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};
  for (int k = 0; k < 6; ++k) {
    const int i = row[k], j = column[k];
    sigma[k] =
        (point.P[i][0] * F[j][0] + point.P[i][1] * F[j][1] + point.P[i][2] * F[j][2]) / point.J;
  }
}

} // namespace brickwall::mechanics
