// Small vectors and 3x3 matrices for point-wise mathematics, on host and device.
#pragma once

#include "contact/base/backend.hpp"

#include <cmath>
#include <cstdint>

namespace brickwall {

struct Vec3 {
  double x = 0, y = 0, z = 0;

  KOKKOS_INLINE_FUNCTION double operator[](int i) const { return i == 0 ? x : (i == 1 ? y : z); }
  KOKKOS_INLINE_FUNCTION double& operator[](int i) { return i == 0 ? x : (i == 1 ? y : z); }
  KOKKOS_INLINE_FUNCTION Vec3& operator+=(const Vec3& b) {
    x += b.x, y += b.y, z += b.z;
    return *this;
  }
  KOKKOS_INLINE_FUNCTION Vec3& operator-=(const Vec3& b) {
    x -= b.x, y -= b.y, z -= b.z;
    return *this;
  }
};

KOKKOS_INLINE_FUNCTION Vec3 operator+(const Vec3& a, const Vec3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
KOKKOS_INLINE_FUNCTION Vec3 operator-(const Vec3& a, const Vec3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
KOKKOS_INLINE_FUNCTION Vec3 operator-(const Vec3& a) {
  return {-a.x, -a.y, -a.z};
}
KOKKOS_INLINE_FUNCTION Vec3 operator*(double s, const Vec3& a) {
  return {s * a.x, s * a.y, s * a.z};
}
KOKKOS_INLINE_FUNCTION double dot(const Vec3& a, const Vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
KOKKOS_INLINE_FUNCTION Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
KOKKOS_INLINE_FUNCTION double norm(const Vec3& a) {
  return std::sqrt(dot(a, a));
}

// Row-major 3x3 matrix.
struct Mat3 {
  double a[3][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};

  KOKKOS_INLINE_FUNCTION double operator()(int i, int j) const { return a[i][j]; }
  KOKKOS_INLINE_FUNCTION double& operator()(int i, int j) { return a[i][j]; }
};

KOKKOS_INLINE_FUNCTION Mat3 operator+(const Mat3& p, const Mat3& q) {
  Mat3 r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      r(i, j) = p(i, j) + q(i, j);
  return r;
}
KOKKOS_INLINE_FUNCTION Mat3 operator*(double s, const Mat3& p) {
  Mat3 r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      r(i, j) = s * p(i, j);
  return r;
}
KOKKOS_INLINE_FUNCTION Mat3 operator*(const Mat3& p, const Mat3& q) {
  Mat3 r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      r(i, j) = p(i, 0) * q(0, j) + p(i, 1) * q(1, j) + p(i, 2) * q(2, j);
  return r;
}
KOKKOS_INLINE_FUNCTION Vec3 operator*(const Mat3& p, const Vec3& v) {
  return {p(0, 0) * v.x + p(0, 1) * v.y + p(0, 2) * v.z,
          p(1, 0) * v.x + p(1, 1) * v.y + p(1, 2) * v.z,
          p(2, 0) * v.x + p(2, 1) * v.y + p(2, 2) * v.z};
}
KOKKOS_INLINE_FUNCTION Mat3 transpose(const Mat3& p) {
  Mat3 r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      r(i, j) = p(j, i);
  return r;
}
KOKKOS_INLINE_FUNCTION double determinant(const Mat3& p) {
  return p(0, 0) * (p(1, 1) * p(2, 2) - p(1, 2) * p(2, 1)) -
         p(0, 1) * (p(1, 0) * p(2, 2) - p(1, 2) * p(2, 0)) +
         p(0, 2) * (p(1, 0) * p(2, 1) - p(1, 1) * p(2, 0));
}
// Inverse of p whose determinant is `det`.
KOKKOS_INLINE_FUNCTION Mat3 inverse(const Mat3& p, double det) {
  const double s = 1.0 / det;
  Mat3 r;
  r(0, 0) = s * (p(1, 1) * p(2, 2) - p(1, 2) * p(2, 1));
  r(0, 1) = s * (p(0, 2) * p(2, 1) - p(0, 1) * p(2, 2));
  r(0, 2) = s * (p(0, 1) * p(1, 2) - p(0, 2) * p(1, 1));
  r(1, 0) = s * (p(1, 2) * p(2, 0) - p(1, 0) * p(2, 2));
  r(1, 1) = s * (p(0, 0) * p(2, 2) - p(0, 2) * p(2, 0));
  r(1, 2) = s * (p(0, 2) * p(1, 0) - p(0, 0) * p(1, 2));
  r(2, 0) = s * (p(1, 0) * p(2, 1) - p(1, 1) * p(2, 0));
  r(2, 1) = s * (p(0, 1) * p(2, 0) - p(0, 0) * p(2, 1));
  r(2, 2) = s * (p(0, 0) * p(1, 1) - p(0, 1) * p(1, 0));
  return r;
}

// Row i of a View [n][3] as a vector.
template <class ViewType>
KOKKOS_INLINE_FUNCTION Vec3 rowOf(const ViewType& view, std::int64_t i) {
  return {view(i, 0), view(i, 1), view(i, 2)};
}
template <class ViewType>
KOKKOS_FORCEINLINE_FUNCTION void prefetchRow(const ViewType& view, std::int64_t i) {
  prefetch(&view(i, 0));
  prefetch(&view(i, 2)); // may lie in the next cache line
}

} // namespace brickwall
