// Reference geometry of one hexahedron from its corner coordinates: Jacobian, volume, mean
// gradient, local frame.
#pragma once

#include "contact/base/vec3.hpp"
#include "mechanics/element/hex8_modes.hpp"

namespace brickwall::mechanics {

using CornerCoordinates = double[8][3]; // X [corner][xyz], length

// X_m = sum_I h_mI X_I, [xyz][mode].
KOKKOS_INLINE_FUNCTION void coordinateModes(const CornerCoordinates& X,
                                            double (&modes)[3][num_modes]) {
  for (int j = 0; j < 3; ++j) {
    double corner[8];
    for (int c = 0; c < 8; ++c)
      corner[c] = X[c][j];
    cornersToModes(corner, modes[j]);
  }
}

// dX/dxi at the point whose mode gradients are given.
KOKKOS_INLINE_FUNCTION Mat3 jacobianAt(const double (&modes)[3][num_modes],
                                       const double (&gradient)[num_modes][3]) {
  Mat3 jacobian;
  for (int j = 0; j < 3; ++j)
    for (int k = 0; k < 3; ++k) {
      double sum = 0;
      for (int m = 0; m < num_modes; ++m)
        sum += modes[j][m] * gradient[m][k];
      jacobian(j, k) = 0.125 * sum;
    }
  return jacobian;
}

// dX/dxi at the centre: half-edges as columns.
KOKKOS_INLINE_FUNCTION Mat3 centreJacobian(const double (&modes)[3][num_modes]) {
  Mat3 jacobian;
  for (int j = 0; j < 3; ++j)
    for (int k = 0; k < 3; ++k)
      jacobian(j, k) = 0.125 * modes[j][k];
  return jacobian;
}

KOKKOS_INLINE_FUNCTION Mat3 cofactorsOf(const Mat3& p) {
  return transpose(inverse(p, 1.0));
}

// Volume by 2x2x2 Gauss quadrature (exact), and the smallest Jacobian determinant at those points.
struct HexVolume {
  double volume = 0;
  double min_determinant = HUGE_VAL;
};
KOKKOS_INLINE_FUNCTION HexVolume hexVolume(const CornerCoordinates& X) {
  double modes[3][num_modes];
  coordinateModes(X, modes);
  HexVolume result;
  for (int point = 0; point < 8; ++point) {
    double xi[3], gradient[num_modes][3];
    gaussPoint(point, xi);
    modeGradients(xi, gradient);
    const double det = determinant(jacobianAt(modes, gradient));
    result.volume += det;
    result.min_determinant = minOf(result.min_determinant, det);
  }
  return result;
}

// Mean gradient by modes, b_m = sum_I h_mI b_I = (1/V) integral of grad psi_m, exact by 2x2x2 Gauss
// quadrature (Flanagan and Belytschko 1981).
KOKKOS_INLINE_FUNCTION void meanGradientModes(const double (&modes)[3][num_modes], double volume,
                                              double (&b)[num_modes][3]) {
  for (int m = 0; m < num_modes; ++m)
    b[m][0] = b[m][1] = b[m][2] = 0;
  for (int point = 0; point < 8; ++point) {
    double xi[3], gradient[num_modes][3];
    gaussPoint(point, xi);
    modeGradients(xi, gradient);
    const Mat3 cofactor = cofactorsOf(jacobianAt(modes, gradient));
    for (int m = 0; m < num_modes; ++m)
      for (int j = 0; j < 3; ++j)
        b[m][j] += (cofactor(j, 0) * gradient[m][0] + cofactor(j, 1) * gradient[m][1] +
                    cofactor(j, 2) * gradient[m][2]) /
                   volume;
  }
}

// G_ij = sum_I b_iI b_jI = (1/8) sum_m b_mi b_mj; the constant mode of b is zero.
KOKKOS_INLINE_FUNCTION Mat3 gradientGram(const double (&b)[num_modes][3]) {
  Mat3 gram;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int m = 0; m < num_modes; ++m)
        gram(i, j) += 0.125 * b[m][i] * b[m][j];
  return gram;
}

// Orthogonal polar factor R of p = R U by Newton's iteration with Frobenius scaling (Higham 1986).
// Requires det p != 0.
KOKKOS_INLINE_FUNCTION Mat3 polarFactor(const Mat3& p) {
  Mat3 r = p;
  for (int iteration = 0; iteration < 30; ++iteration) {
    const Mat3 inverse_transpose = transpose(inverse(r, determinant(r)));
    double square = 0, inverse_square = 0;
    for (int k = 0; k < 9; ++k) {
      square += r(k / 3, k % 3) * r(k / 3, k % 3);
      inverse_square += inverse_transpose(k / 3, k % 3) * inverse_transpose(k / 3, k % 3);
    }
    const double scale = std::sqrt(std::sqrt(inverse_square / square));
    const Mat3 next = (0.5 * scale) * r + (0.5 / scale) * inverse_transpose;
    double change = 0;
    for (int k = 0; k < 9; ++k)
      change = maxOf(change, std::fabs(next(k / 3, k % 3) - r(k / 3, k % 3)));
    r = next;
    if (change < 1e-15)
      break;
  }
  return r;
}

// Edges of a hexahedron as pairs of corners.
constexpr int num_hex_edges = 12;
KOKKOS_INLINE_FUNCTION void edgeCorners(int edge, int& from, int& to) {
  const int ring = edge % 4;
  from = edge < 4 ? ring : (edge < 8 ? 4 + ring : ring);
  to = edge < 4 ? (ring + 1) % 4 : (edge < 8 ? 4 + (ring + 1) % 4 : 4 + ring);
}
KOKKOS_INLINE_FUNCTION double longestEdge(const CornerCoordinates& X) {
  double longest = 0;
  for (int edge = 0; edge < num_hex_edges; ++edge) {
    int a, b;
    edgeCorners(edge, a, b);
    const Vec3 d = {X[b][0] - X[a][0], X[b][1] - X[a][1], X[b][2] - X[a][2]};
    longest = maxOf(longest, norm(d));
  }
  return longest;
}

// Of element `elem`, from Views of the device or of the host.
template <class Connectivity, class Coordinates>
KOKKOS_INLINE_FUNCTION void gatherCorners(const Connectivity& elem_to_nodes,
                                          const Coordinates& coordinates, int elem,
                                          CornerCoordinates& X) {
  for (int c = 0; c < 8; ++c) {
    const int node = elem_to_nodes(elem, c);
    for (int j = 0; j < 3; ++j)
      X[c][j] = coordinates(node, j);
  }
}

} // namespace brickwall::mechanics
