// Walsh-Hadamard modes of the eight corners of a hexahedron; theory.md, equation (1). h_mI, m =
// 1..7, are xi, eta, zeta, eta zeta, zeta xi, xi eta, xi eta zeta at corner I; psi_m are the same
// as functions. With u_m = sum_I h_mI u_I the trilinear field is u(xi) = u_mean + (1/8) sum_m u_m
// psi_m(xi). Mode m is stored at index m - 1. The last four are the hourglass modes (Flanagan and
// Belytschko 1981).
#pragma once

#include "contact/base/backend.hpp"

namespace brickwall::mechanics {

constexpr int num_modes = 7;
constexpr int num_hourglass_modes = 4; // the last four modes
constexpr int num_face_modes = 4; // 1, xi, eta, xi eta of the corners of a face

// Local coordinates of the corners in Exodus order.
KOKKOS_INLINE_FUNCTION double cornerXi(int corner, int axis) {
  const int bits = corner ^ ((corner >> 1) & 1); // zeta, eta, xi in binary
  return ((bits >> axis) & 1) ? 1.0 : -1.0;
}

// Modes 1, xi, eta, xi eta of a face with corners a at (-,-), b (+,-), c (+,+), d (-,+).
template <class T>
KOKKOS_FORCEINLINE_FUNCTION void faceToModes(const T& a, const T& b, const T& c, const T& d,
                                             T (&face)[num_face_modes]) {
  const T low = a + b, low_xi = b - a, high = d + c, high_xi = c - d;
  face[0] = low + high;
  face[1] = low_xi + high_xi;
  face[2] = high - low;
  face[3] = high_xi - low_xi;
}
template <class T>
KOKKOS_FORCEINLINE_FUNCTION void facesToModes(const T (&low)[num_face_modes],
                                              const T (&high)[num_face_modes],
                                              T (&modes)[num_modes]) {
  modes[0] = low[1] + high[1];
  modes[1] = low[2] + high[2];
  modes[2] = high[0] - low[0];
  modes[3] = high[2] - low[2];
  modes[4] = high[1] - low[1];
  modes[5] = low[3] + high[3];
  modes[6] = high[3] - low[3];
}

// modes[m-1] = sum_I h_mI corner[I], from the faces at zeta = -1 and +1. The order of operations is
// that of the sweeps over lattices.
template <class T>
KOKKOS_FORCEINLINE_FUNCTION void cornersToModes(const T (&corner)[8], T (&modes)[num_modes]) {
  T low[num_face_modes], high[num_face_modes];
  faceToModes(corner[0], corner[1], corner[2], corner[3], low);
  faceToModes(corner[4], corner[5], corner[6], corner[7], high);
  facesToModes(low, high, modes);
}

// corner[I] = sum_m h_mI modes[m-1], the transpose. In integers the corner values sum to exactly
// zero.
template <class T>
KOKKOS_INLINE_FUNCTION void modesToCorners(const T (&modes)[num_modes], T (&corner)[8]) {
  // Coefficients of 1, eta, xi, xi eta at zeta = -1 (minus) and +1 (plus).
  const T eta_minus = modes[1] - modes[3], eta_plus = modes[1] + modes[3];
  const T xi_minus = modes[0] - modes[4], xi_plus = modes[0] + modes[4];
  const T xe_minus = modes[5] - modes[6], xe_plus = modes[5] + modes[6];
  const T a0 = -modes[2] - eta_minus, b0 = xi_minus - xe_minus; // at eta = -1 the value is a + xi b
  const T a1 = eta_minus - modes[2], b1 = xi_minus + xe_minus;
  const T a2 = modes[2] - eta_plus, b2 = xi_plus - xe_plus;
  const T a3 = modes[2] + eta_plus, b3 = xi_plus + xe_plus;
  corner[0] = a0 - b0, corner[1] = a0 + b0;
  corner[3] = a1 - b1, corner[2] = a1 + b1;
  corner[4] = a2 - b2, corner[5] = a2 + b2;
  corner[7] = a3 - b3, corner[6] = a3 + b3;
}

// The transpose for the three linear modes alone.
template <class T>
KOKKOS_INLINE_FUNCTION void linearModesToCorners(const T (&modes)[3], T (&corner)[8]) {
  const T minus = -modes[2] - modes[1], mixed = modes[1] - modes[2];
  corner[0] = minus - modes[0], corner[1] = minus + modes[0];
  corner[3] = mixed - modes[0], corner[2] = mixed + modes[0];
  corner[4] = -corner[2], corner[5] = -corner[3];
  corner[7] = -corner[1], corner[6] = -corner[0];
}

// Gradient of psi_m with respect to the local coordinates at the point xi.
KOKKOS_INLINE_FUNCTION void modeGradients(const double (&xi)[3], double (&gradient)[num_modes][3]) {
  for (int m = 0; m < num_modes; ++m)
    for (int k = 0; k < 3; ++k)
      gradient[m][k] = m == k ? 1 : 0;
  gradient[3][1] = gradient[4][0] = xi[2];
  gradient[3][2] = gradient[5][0] = xi[1];
  gradient[4][2] = gradient[5][1] = xi[0];
  gradient[6][0] = xi[1] * xi[2];
  gradient[6][1] = xi[2] * xi[0];
  gradient[6][2] = xi[0] * xi[1];
}

// The points of the 2x2x2 Gauss rule, each of weight 1.
KOKKOS_INLINE_FUNCTION void gaussPoint(int point, double (&xi)[3]) {
  constexpr double s = 0.57735026918962576451; // 1/sqrt(3)
  for (int axis = 0; axis < 3; ++axis)
    xi[axis] = ((point >> axis) & 1) ? s : -s;
}

} // namespace brickwall::mechanics
