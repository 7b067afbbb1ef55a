// Reference geometry of the one-point hexahedron (hex8_one_point.hpp) in three forms: a general
// hexahedron, a parallelepiped, and a box along the axes of space.
#pragma once

#include "mechanics/element/hex8_geometry.hpp"

namespace brickwall::mechanics {

// General hexahedron.
template <class Real>
struct OnePointGeometry {
  static constexpr int gradient_modes = num_modes;
  static constexpr int size = 46; // numbers stored per element
  Real B[num_modes][3]; // b_m/8, so that H_ij = sum_m u_mi B_mj
  Real M[num_hourglass_modes][3]; // h_a . X
  // The rows of Q are the local axes (the transposed polar factor of dX/dxi), each divided by the
  // norm of its column of dX/dxi.
  Real Q[3][3];
  Real thinness[3]; // (l_j^-2 + l_k^-2)/l_i^-2 for half-edges l
  Real volume;
};

// Parallelepiped: b has linear modes only and h_a . X = 0, so gamma = h/8.
struct OnePointBox {
  static constexpr int gradient_modes = 3;
  double B[3][3];
  double Q[3][3];
  double thinness[3];
  double volume;
};

// Parallelepiped whose edges are along the axes of space, in their order: B is diagonal and the
// local axes are those of space. Its forces are those of OnePointBox up to rounding.
struct OnePointBrick {
  static constexpr int gradient_modes = 3;
  double b[3]; // diagonal of B
  double inverse_length[3]; // inverse half-edges
  double volume;
};

// The numbering of the corners changes only the order and the signs of the rows of Q, and does not
// change the energy.
template <class Geometry>
KOKKOS_INLINE_FUNCTION void setFrame(const Mat3& jacobian, Geometry& geometry) {
  const Mat3 r = polarFactor(jacobian);
  double square[3]; // squares of inverse half-edges
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
// Requires isOnePointBrick(jacobian).
KOKKOS_INLINE_FUNCTION OnePointBrick onePointBrick(const Mat3& jacobian) {
  OnePointBrick brick;
  brick.volume = 8 * (jacobian(0, 0) * jacobian(1, 1) * jacobian(2, 2));
  for (int k = 0; k < 3; ++k) {
    brick.inverse_length[k] = 1 / jacobian(k, k);
    brick.b[k] = 0.125 * brick.inverse_length[k];
  }
  return brick;
}

} // namespace brickwall::mechanics
