// A few doubles side by side in SIMD lanes, and vectors of them: point-wise functions are templates on the scalar type, double
// for one point or RealLanes for eight. Each lane's arithmetic is that of a double, so results do not depend on the lane.
// Lanes are host code (GNU vector types: g++, clang); devices take double.
#pragma once

#include "contact/base/vec3.hpp"

#include <cstring>
#include <type_traits>

namespace brickwall {

struct RealLanes {
  static constexpr int width = 8;
  typedef double vector __attribute__((vector_size(64)));
  vector v;

  RealLanes() = default;
  RealLanes(vector x) : v(x) {}
  RealLanes(double x) : v(vector{} + x) {}
  RealLanes& operator+=(const RealLanes& b) {
    v += b.v;
    return *this;
  }
  RealLanes& operator-=(const RealLanes& b) {
    v -= b.v;
    return *this;
  }
};
inline RealLanes operator+(const RealLanes& a, const RealLanes& b) {
  return a.v + b.v;
}
inline RealLanes operator-(const RealLanes& a, const RealLanes& b) {
  return a.v - b.v;
}
inline RealLanes operator*(const RealLanes& a, const RealLanes& b) {
  return a.v * b.v;
}
inline RealLanes operator/(const RealLanes& a, const RealLanes& b) {
  return a.v / b.v;
}
inline RealLanes operator-(const RealLanes& a) {
  return -a.v;
}

// What comparisons of lanes give: all bits of a lane, or none.
struct LaneMask {
  typedef std::int64_t vector __attribute__((vector_size(64)));
  vector v;

  LaneMask() = default;
  LaneMask(vector x) : v(x) {}
  LaneMask(bool x) : v(vector{} - static_cast<std::int64_t>(x)) {}
};
inline LaneMask operator<(const RealLanes& a, const RealLanes& b) {
  return a.v < b.v;
}
inline LaneMask operator<=(const RealLanes& a, const RealLanes& b) {
  return a.v <= b.v;
}
inline LaneMask operator>(const RealLanes& a, const RealLanes& b) {
  return a.v > b.v;
}
inline LaneMask operator==(const RealLanes& a, const RealLanes& b) {
  return a.v == b.v;
}
inline LaneMask operator&(const LaneMask& a, const LaneMask& b) {
  return a.v & b.v;
}
inline LaneMask operator|(const LaneMask& a, const LaneMask& b) {
  return a.v | b.v;
}
inline LaneMask operator!(const LaneMask& a) {
  return ~a.v;
}

// a where the mask is set, else b.
KOKKOS_INLINE_FUNCTION double where(bool mask, double a, double b) {
  return mask ? a : b;
}
inline RealLanes where(const LaneMask& mask, const RealLanes& a, const RealLanes& b) {
  typedef LaneMask::vector bits;
  return (RealLanes::vector)(((bits)a.v & mask.v) | ((bits)b.v & ~mask.v));
}
KOKKOS_INLINE_FUNCTION bool isAny(bool mask) {
  return mask;
}
inline bool isAny(const LaneMask& mask) {
  std::int64_t any = 0;
  for (int lane = 0; lane < RealLanes::width; ++lane)
    any |= mask.v[lane];
  return any != 0;
}

KOKKOS_INLINE_FUNCTION double rootOf(double a) {
  return std::sqrt(a);
}
inline RealLanes rootOf(const RealLanes& a) {
  RealLanes root;
  for (int lane = 0; lane < RealLanes::width; ++lane)
    root.v[lane] = __builtin_sqrt(a.v[lane]);
  return root;
}
KOKKOS_INLINE_FUNCTION double magnitude(double a) {
  return std::fabs(a);
}
inline RealLanes magnitude(const RealLanes& a) {
  typedef LaneMask::vector bits;
  return (RealLanes::vector)((bits)a.v & INT64_MAX);
}
inline RealLanes maxOf(const RealLanes& a, const RealLanes& b) {
  return where(a < b, b, a);
}

// The scalar types of host and device code that takes `simd_width` points at once, and its masks.
template <class Real>
struct MaskOf {
  using type = LaneMask;
};
template <>
struct MaskOf<double> {
  using type = bool;
};

// For code that takes as many points at once as is best: devices, of width 1, do not even hear of vectors.
template <int width>
struct RealOfWidth {
  using type = RealLanes;
};
template <>
struct RealOfWidth<1> {
  using type = double;
};

// Vec3 of any scalar type.
template <class Real>
struct Triple {
  Real x, y, z;
};
KOKKOS_INLINE_FUNCTION Triple<double> triple(const Vec3& a) {
  return {a.x, a.y, a.z};
}
template <class Real>
KOKKOS_INLINE_FUNCTION Triple<Real> operator+(const Triple<Real>& a, const Triple<Real>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class Real>
KOKKOS_INLINE_FUNCTION Triple<Real> operator-(const Triple<Real>& a, const Triple<Real>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class Real>
KOKKOS_INLINE_FUNCTION Triple<Real> operator-(const Triple<Real>& a) {
  return {-a.x, -a.y, -a.z};
}
template <class Real>
KOKKOS_INLINE_FUNCTION Triple<Real> operator*(const Real& s, const Triple<Real>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class Real>
KOKKOS_INLINE_FUNCTION Real dot(const Triple<Real>& a, const Triple<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class Real>
KOKKOS_INLINE_FUNCTION Triple<Real> cross(const Triple<Real>& a, const Triple<Real>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

} // namespace brickwall
