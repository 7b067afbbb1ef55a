// Eigenvalues of small symmetric matrices by cyclic Jacobi rotations, and the Cholesky factor of a
// 3x3 matrix.
#pragma once

#include "contact/base/vec3.hpp"

namespace brickwall::mechanics {

// Overwrites the matrix. Its diagonal then holds the eigenvalues in no particular order, accurate
// to rounding of the norm, and the columns of `vectors`, if given, the unit eigenvectors.
template <int N>
KOKKOS_INLINE_FUNCTION void diagonalise(double (&a)[N][N], double (*vectors)[N] = nullptr) {
  for (int k = 0; vectors && k < N * N; ++k)
    vectors[k / N][k % N] = k / N == k % N ? 1 : 0;
  for (int sweep = 0; sweep < 30; ++sweep) {
    double off = 0, diagonal = 0;
    for (int i = 0; i < N; ++i) {
      diagonal += a[i][i] * a[i][i];
      for (int j = 0; j < i; ++j)
        off += a[i][j] * a[i][j];
    }
    if (!(off > 1e-32 * diagonal))
      return;
    for (int p = 0; p < N - 1; ++p)
      for (int q = p + 1; q < N; ++q) {
        if (a[p][q] == 0)
          continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t =
            (theta >= 0 ? 1.0 : -1.0) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < N; ++k) {
          const double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq;
          a[k][q] = s * kp + c * kq;
        }
        for (int k = 0; k < N; ++k) {
          const double pk = a[p][k], qk = a[q][k];
          a[p][k] = c * pk - s * qk;
          a[q][k] = s * pk + c * qk;
        }
        for (int k = 0; vectors && k < N; ++k) {
          const double kp = vectors[k][p], kq = vectors[k][q];
          vectors[k][p] = c * kp - s * kq;
          vectors[k][q] = s * kp + c * kq;
        }
      }
  }
}

template <int N>
KOKKOS_INLINE_FUNCTION void symmetricEigenvalues(const double (&matrix)[N][N],
                                                 double (&eigenvalues)[N]) {
  double a[N][N];
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j)
      a[i][j] = matrix[i][j];
  diagonalise(a);
  for (int i = 0; i < N; ++i)
    eigenvalues[i] = a[i][i];
}

template <int N>
KOKKOS_INLINE_FUNCTION double largestEigenvalue(const double (&matrix)[N][N]) {
  double eigenvalues[N];
  symmetricEigenvalues(matrix, eigenvalues);
  double largest = eigenvalues[0];
  for (int i = 1; i < N; ++i)
    largest = maxOf(largest, eigenvalues[i]);
  return largest;
}

// Lower Cholesky factor L of a positive definite matrix L L^T.
KOKKOS_INLINE_FUNCTION void cholesky(const Mat3& p, double (&L)[3][3]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double sum = p(i, j);
      for (int k = 0; k < minOf(i, j); ++k)
        sum -= L[i][k] * L[j][k];
      if (j > i)
        L[i][j] = 0;
      else
        L[i][j] = i == j ? std::sqrt(sum) : sum / L[j][j];
    }
}

} // namespace brickwall::mechanics
