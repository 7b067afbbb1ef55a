// The least relative change of nodal masses that gives a body its mass, centre and second moments,
// by ten moment conditions; theory.md, equations (36) to (39).
#pragma once

#include "contact/base/fixed_point.hpp"
#include "contact/base/vec3.hpp"
#include "mechanics/element/symmetric_eigenvalue.hpp"

namespace brickwall::mechanics {

// The ten moments are those of the monomials 1, x, y, z, xx, yy, zz, yz, zx, xy.
constexpr int num_moments = 10;
constexpr int num_linear = 4; // the first of them
constexpr int num_quadratic = num_moments - num_linear;

// The components whose product is the a-th quadratic monomial.
struct Factors {
  int i, j;
};
KOKKOS_INLINE_FUNCTION Factors factorsOf(int a) {
  return a < 3 ? Factors{a, a} : Factors{(a - 2) % 3, (a - 1) % 3};
}

KOKKOS_INLINE_FUNCTION void monomials(const Vec3& y, double (&q)[num_moments]) {
  const double values[num_moments] = {1,         y.x,       y.y,       y.z,       y.x * y.x,
                                      y.y * y.y, y.z * y.z, y.y * y.z, y.z * y.x, y.x * y.y};
  for (int a = 0; a < num_moments; ++a)
    q[a] = values[a];
}

// Products of two of them are the 35 monomials of degree 4 at most. Calls take(n, i, j, k) for the
// n-th, x^i y^j z^k.
constexpr int max_degree = 4, num_products = 35;
template <class Take>
KOKKOS_INLINE_FUNCTION void forEachProduct(const Take& take) {
  int n = 0;
  for (int i = 0; i <= max_degree; ++i)
    for (int j = 0; i + j <= max_degree; ++j)
      for (int k = 0; i + j + k <= max_degree; ++k)
        take(n++, i, j, k);
}

// Sums of mu q_a and of mu^2 q_a q_b over the nodes, with mu the lumped mass over that of the body.
// The sum of mu y.y is at most 9, with one element in a body, or little more if it is distorted.
using NodeSums = LimbSums<num_moments + num_products>;
inline LimbScale nodeScale() {
  return LimbScale::forLargest(1024);
}
// m' = m (1 + mu (linear.q + taken quadratic.q)).
struct Correction {
  double linear[num_moments] = {}, quadratic[num_moments] = {};
  double taken = 1;

  struct Parts {
    double linear, quadratic;
  };
  KOKKOS_INLINE_FUNCTION Parts partsAt(const Vec3& y, double mu) const {
    double q[num_moments];
    monomials(y, q);
    Parts parts = {0, 0};
    for (int a = 0; a < num_moments; ++a) {
      parts.linear += mu * linear[a] * q[a];
      parts.quadratic += mu * quadratic[a] * q[a];
    }
    return parts;
  }
};

// x = A^-1 b for a positive definite A.
inline void solve(const double (&A)[num_linear][num_linear], double (&x)[num_linear]) {
  double L[num_linear][num_linear];
  for (int i = 0; i < num_linear; ++i) {
    for (int j = 0; j <= i; ++j) {
      double sum = A[i][j];
      for (int k = 0; k < j; ++k)
        sum -= L[i][k] * L[j][k];
      L[i][j] = i == j ? std::sqrt(sum) : sum / L[j][j];
    }
    for (int k = 0; k < i; ++k)
      x[i] -= L[i][k] * x[k];
    x[i] /= L[i][i];
  }
  for (int i = num_linear - 1; i >= 0; --i) {
    for (int k = i + 1; k < num_linear; ++k)
      x[i] -= L[k][i] * x[k];
    x[i] /= L[i][i];
  }
}

// Residuals of the ten moments and the matrix G of their products.
struct MomentSystem {
  double residual[num_moments], gram[num_moments][num_moments];
  double linear_gram[num_linear][num_linear];
};
inline MomentSystem systemOf(const NodeSums& sums) {
  MomentSystem system;
  double products[max_degree + 1][max_degree + 1][max_degree + 1];
  forEachProduct([&](int n, int i, int j, int k) {
    products[i][j][k] = sums.sum[num_moments + n].value(nodeScale());
  });
  for (int a = 0; a < num_moments; ++a) {
    const bool is_one = a == 0 || (a >= num_linear && a < num_linear + 3);
    system.residual[a] = (is_one ? 1 : 0) - sums.sum[a].value(nodeScale());
    for (int b = 0; b < num_moments; ++b) {
      int power[3] = {0, 0, 0};
      for (const int c : {a, b})
        if (c >= num_linear) {
          ++power[factorsOf(c - num_linear).i];
          ++power[factorsOf(c - num_linear).j];
        } else if (c > 0) {
          ++power[c - 1];
        }
      system.gram[a][b] = products[power[0]][power[1]][power[2]];
      if (a < num_linear && b < num_linear)
        system.linear_gram[a][b] = system.gram[a][b];
    }
  }
  return system;
}

// Adds the least change with the body's second moments that leaves mass and centre alone.
inline void addQuadratic(const MomentSystem& system, Correction& correction) {
  // Quadratic monomials without their linear parts. Mixed ones count twice in a matrix, so that
  // rotations of y act on the six as rotations.
  double part[num_quadratic][num_linear], S[num_quadratic][num_quadratic], r[num_quadratic];
  const auto weight = [](int a) { return a < 3 ? 1.0 : std::sqrt(2.0); };
  for (int a = 0; a < num_quadratic; ++a) {
    const double(&row)[num_moments] = system.gram[num_linear + a];
    for (int i = 0; i < num_linear; ++i)
      part[a][i] = row[i];
    solve(system.linear_gram, part[a]);
    r[a] = system.residual[num_linear + a];
    for (int i = 0; i < num_linear; ++i)
      r[a] -= part[a][i] * system.residual[i];
    r[a] *= weight(a);
    for (int b = 0; b < num_quadratic; ++b) {
      S[a][b] = row[num_linear + b];
      for (int i = 0; i < num_linear; ++i)
        S[a][b] -= part[a][i] * system.gram[i][num_linear + b];
      S[a][b] *= weight(a) * weight(b);
    }
  }
  double modes[num_quadratic][num_quadratic];
  diagonalise(S, modes);
  const double squares = system.gram[0][0]; // sum of mu^2
  constexpr double least_variance = 1e-3;
  for (int mode = 0; mode < num_quadratic; ++mode) {
    double needed = 0;
    for (int a = 0; a < num_quadratic; ++a)
      needed += modes[a][mode] * r[a];
    const double variance = S[mode][mode];
    if (!(variance > least_variance * squares && needed * needed * squares <= variance))
      continue;
    for (int a = 0; a < num_quadratic; ++a) {
      const double share = weight(a) * modes[a][mode] * needed / variance;
      correction.quadratic[num_linear + a] += share;
      for (int i = 0; i < num_linear; ++i)
        correction.quadratic[i] -= share * part[a][i];
    }
  }
}

// The least change with the mass and the centre of the body, and on top of it that with its second
// moments; equations (38) and (39).
inline Correction correctionOf(const NodeSums& sums) {
  const MomentSystem system = systemOf(sums);
  Correction correction;
  double c[num_linear];
  for (int i = 0; i < num_linear; ++i)
    c[i] = system.residual[i];
  solve(system.linear_gram, c);
  for (int i = 0; i < num_linear; ++i)
    correction.linear[i] = c[i];
  addQuadratic(system, correction);
  return correction;
}

} // namespace brickwall::mechanics
