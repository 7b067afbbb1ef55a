// Point-wise parts of the stable time step: an element's shape, its largest omega^2, and the change
// of omega^2 as it deforms.
#pragma once

#include "mechanics/element/hex8_geometry.hpp"
#include "mechanics/element/material_tangent.hpp"
#include "mechanics/element/symmetric_eigenvalue.hpp"
#include "mechanics/stability/stable_time_step.hpp"

namespace brickwall::mechanics {

// Geometry of an element for the bounds.
struct ElementShape {
  double b[num_modes][3]; // modes of the mean gradient
  double hourglass[num_hourglass_modes][3]; // h_a . X
  double inverse_length[3]; // of half-edges
  Mat3 gram; // G
  double length; // l of bulk viscosity
  bool parallelepiped;
};
KOKKOS_INLINE_FUNCTION ElementShape shapeOf(const MeshViews& mesh, int elem) {
  ElementShape shape;
  double corners[8][3], modes[3][num_modes];
  gatherCorners(mesh.elem_to_nodes, mesh.reference_coordinates, elem, corners);
  coordinateModes(corners, modes);
  meanGradientModes(modes, hexVolume(corners).volume, shape.b);
  shape.gram = gradientGram(shape.b);
  FullGeometry<double> geometry;
  coordinateModes(corners, geometry.X);
  shape.length = elementLength(geometry);
  const Mat3 jacobian = centreJacobian(modes);
  double linear = 0, bent = 0;
  for (int j = 0; j < 3; ++j) {
    const Vec3 column = {jacobian(0, j), jacobian(1, j), jacobian(2, j)};
    shape.inverse_length[j] = 1 / norm(column);
    for (int a = 0; a < num_hourglass_modes; ++a)
      shape.hourglass[a][j] = modes[j][3 + a];
    for (int m = 0; m < num_modes; ++m) {
      double& largest = m < 3 ? linear : bent;
      largest = maxOf(largest, std::fabs(modes[j][m]));
    }
  }
  shape.parallelepiped = bent <= 1e-9 * linear;
  return shape;
}

// The bound is exact on parallelepipeds; elsewhere hourglass modes couple with the mean gradient.
KOKKOS_INLINE_FUNCTION double stepOf(double omega_square, bool parallelepiped) {
  return (parallelepiped ? 2.0 : 2.0 * 0.98) / std::sqrt(omega_square);
}

// c = (8/rho) l rho c_d xi tr G with G of the present configuration. The viscous stress is
// proportional to tr D alone, so the element's C has this single nonzero eigenvalue.
KOKKOS_INLINE_FUNCTION double viscousRate(const StabilityTerms& load, const Material& material,
                                          double length, double gram_trace) {
  const BulkViscosity& b = load.viscosity;
  const double xi = b.linear + b.quadratic * b.quadratic * load.rate;
  return 8 * length * material.dilatationalSpeed() * xi * gram_trace;
}

// The root of dt^2 omega^2/4 + dt c/2 = 1; `step` is 2/omega.
KOKKOS_INLINE_FUNCTION double viscousStep(double step, double c) {
  if (c == 0)
    return step;
  const double xi = 0.25 * c * step;
  return step / (xi + std::sqrt(xi * xi + 1));
}
// The same with a mass reduced by contact's fraction.
KOKKOS_INLINE_FUNCTION double loadedStep(double step, double c, const StabilityTerms& load) {
  const double remaining = 1 - load.contact;
  return viscousStep(step * std::sqrt(remaining), c / remaining);
}

// L^T A L with G = L L^T: the moduli dP/dH on the mean gradients. Its largest eigenvalue times
// 8/rho is omega^2.
KOKKOS_INLINE_FUNCTION void onMeanGradients(const double (&A)[9][9], const Mat3& gram,
                                            double (&matrix)[9][9]) {
  double L[3][3], half[9][9]; // A L
  cholesky(gram, L);
  for (int r = 0; r < 9; ++r)
    for (int k = 0; k < 3; ++k)
      for (int q = 0; q < 3; ++q) {
        double sum = 0;
        for (int l = q; l < 3; ++l)
          sum += A[r][3 * k + l] * L[l][q];
        half[r][3 * k + q] = sum;
      }
  for (int i = 0; i < 3; ++i)
    for (int p = 0; p < 3; ++p)
      for (int c = 0; c < 9; ++c) {
        double sum = 0;
        for (int j = p; j < 3; ++j)
          sum += L[j][p] * half[3 * i + j][c];
        matrix[3 * i + p][c] = sum;
      }
}

// Largest row sum of magnitudes, a bound of all eigenvalues.
template <int N>
KOKKOS_INLINE_FUNCTION double largestRow(const double (&matrix)[N][N]) {
  double largest = 0;
  for (int r = 0; r < N; ++r) {
    double sum = 0;
    for (int c = 0; c < N; ++c)
      sum += std::fabs(matrix[r][c]);
    largest = !(sum <= largest) ? sum : largest; // NaN stays
  }
  return largest;
}

// A(U) - A(0) with F = R U: A_mjnl R_mi R_nk less the moduli at rest. Those of the linear material
// do not change.
KOKKOS_INLINE_FUNCTION void changeOfModuli(const double (&A)[9][9], const double (&H)[3][3],
                                           const Material& material, double (&change)[9][9]) {
  double rest[9][9], half[9][9];
  const double zero[3][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  Material linear = material;
  linear.model = MaterialModel::linear;
  materialTangent(zero, linear, rest);
  Mat3 F;
  for (int k = 0; k < 9; ++k)
    F(k / 3, k % 3) = H[k / 3][k % 3] + (k % 4 == 0 ? 1.0 : 0.0);
  Mat3 R = F;
  if (material.model == MaterialModel::linear)
    for (int k = 0; k < 9; ++k)
      R(k / 3, k % 3) = k % 4 == 0 ? 1.0 : 0.0;
  else
    R = polarFactor(F);
  for (int r = 0; r < 9; ++r)
    for (int k = 0; k < 3; ++k)
      for (int l = 0; l < 3; ++l)
        half[r][3 * k + l] = A[r][l] * R(0, k) + A[r][3 + l] * R(1, k) + A[r][6 + l] * R(2, k);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int c = 0; c < 9; ++c)
        change[3 * i + j][c] = half[j][c] * R(0, i) + half[3 + j][c] * R(1, i) +
                               half[6 + j][c] * R(2, i) - rest[3 * i + j][c];
}

// Growth of the hourglass modes' omega^2: at most max(4 mu, E/(1 - nu))/(3 rho a^2) at rest, with a
// the shortest half-edge, times the square of the largest stretch.
KOKKOS_INLINE_FUNCTION double hourglassGrowth(const double (&H)[3][3], const Material& material,
                                              const ElementShape& shape) {
  double C[3][3]; // F^T F - I
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      C[i][j] = H[i][j] + H[j][i] + H[0][i] * H[0][j] + H[1][i] * H[1][j] + H[2][i] * H[2][j];
  double shortest = 0; // inverse length
  for (int j = 0; j < 3; ++j)
    shortest = maxOf(shortest, shape.inverse_length[j]);
  const double modulus = maxOf(4 * material.mu(), material.youngs / (1 - material.poisson));
  return largestRow(C) * modulus * shortest * shortest / (3 * material.density);
}

// Bound of the rotation of corners relative to the element's mean rotation: |F - F_corner|/sqrt(2)
// with F_corner - F = sum of g_a (x) grad h_a, whose gradients have unit size along the half-edges
// on which they depend.
KOKKOS_INLINE_FUNCTION double turnOfCorners(const double (&u)[3][num_modes],
                                            const double (&H)[3][3], const ElementShape& shape) {
  double square[3]; // 1/length^2
  for (int j = 0; j < 3; ++j)
    square[j] = shape.inverse_length[j] * shape.inverse_length[j];
  const double all = square[0] + square[1] + square[2];
  double turn = 0;
  for (int a = 0; a < num_hourglass_modes; ++a) {
    double g = 0;
    for (int i = 0; i < 3; ++i) {
      const double* M = shape.hourglass[a];
      const double g_i = 0.125 * (u[i][3 + a] - (H[i][0] * M[0] + H[i][1] * M[1] + H[i][2] * M[2]));
      g += g_i * g_i;
    }
    turn += std::sqrt(0.5 * g * (a < 3 ? all - square[a < 3 ? a : 0] : all));
  }
  return turn;
}

// tr(F^-T G F^-1), or tr G for the linear material.
KOKKOS_INLINE_FUNCTION double deformedTrace(const double (&H)[3][3], const Mat3& gram,
                                            MaterialModel model) {
  double F[3][3], c[3][3], sum = 0;
  if (model == MaterialModel::linear)
    return gram(0, 0) + gram(1, 1) + gram(2, 2);
  deformationGradient(H, F);
  cofactors(F, c);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k)
        sum += c[i][j] * gram(j, k) * c[i][k];
  const double J = 1 + volumeChange(H);
  return sum / (J * J);
}

} // namespace brickwall::mechanics
