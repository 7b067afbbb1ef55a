// SIMD lanes of doubles: the element functions are templates on the scalar type, double for one element or Pack for
// simd_width elements at once. Each lane's arithmetic is that of a double, so results do not depend on the
// lane. Host code only; GNU vector types (g++, clang).
#pragma once

#include "contact/base/backend.hpp"
#include "contact/base/fixed_point.hpp"

#include <cmath>
#include <type_traits>

namespace brickwall::mechanics {

// The vector types of W lanes (g++ takes no template argument in the attribute).
template <int W>
struct VectorsOf;
template <>
struct VectorsOf<8> {
  typedef double real __attribute__((vector_size(64)));
  typedef std::int64_t integer __attribute__((vector_size(64)));
};

template <int W>
struct PackOf {
  using vector = typename VectorsOf<W>::real;
  vector v;

  PackOf() = default;
  PackOf(vector x) : v(x) {}
  PackOf(double x) : v(vector{} + x) {}
  double operator[](int lane) const { return v[lane]; }
  PackOf& operator+=(const PackOf& b) {
    v += b.v;
    return *this;
  }
  PackOf& operator-=(const PackOf& b) {
    v -= b.v;
    return *this;
  }
};
template <int W>
inline PackOf<W> operator+(const PackOf<W>& a, const PackOf<W>& b) {
  return a.v + b.v;
}
template <int W>
inline PackOf<W> operator-(const PackOf<W>& a, const PackOf<W>& b) {
  return a.v - b.v;
}
template <int W>
inline PackOf<W> operator*(const PackOf<W>& a, const PackOf<W>& b) {
  return a.v * b.v;
}
template <int W>
inline PackOf<W> operator/(const PackOf<W>& a, const PackOf<W>& b) {
  return a.v / b.v;
}
template <int W>
inline PackOf<W> operator-(const PackOf<W>& a) {
  return -a.v;
}
template <int W>
inline PackOf<W> operator+(const PackOf<W>& a, double b) {
  return a.v + b;
}
template <int W>
inline PackOf<W> operator+(double a, const PackOf<W>& b) {
  return a + b.v;
}
template <int W>
inline PackOf<W> operator-(const PackOf<W>& a, double b) {
  return a.v - b;
}
template <int W>
inline PackOf<W> operator*(const PackOf<W>& a, double b) {
  return a.v * b;
}
template <int W>
inline PackOf<W> operator*(double a, const PackOf<W>& b) {
  return a * b.v;
}
template <int W>
inline PackOf<W> operator/(double a, const PackOf<W>& b) {
  return a / b.v;
}
template <int W>
inline PackOf<W> operator/(const PackOf<W>& a, double b) {
  return a.v / b;
}

// Integers in the same lanes.
template <int W>
struct IntPackOf {
  using vector = typename VectorsOf<W>::integer;
  vector v;

  IntPackOf() = default;
  IntPackOf(vector x) : v(x) {}
  std::int64_t operator[](int lane) const { return v[lane]; }
};
template <int W>
inline IntPackOf<W> operator+(const IntPackOf<W>& a, const IntPackOf<W>& b) {
  return a.v + b.v;
}
template <int W>
inline IntPackOf<W> operator-(const IntPackOf<W>& a, const IntPackOf<W>& b) {
  return a.v - b.v;
}
template <int W>
inline IntPackOf<W> operator-(const IntPackOf<W>& a) {
  return -a.v;
}

// The smaller, or NaN as soon as one is NaN.
KOKKOS_INLINE_FUNCTION double minOrNan(double a, double b) {
  return a < b ? a : (a != a ? a : b);
}
template <int W>
inline PackOf<W> minOrNan(const PackOf<W>& a, const PackOf<W>& b) {
  return a.v < b.v ? a.v : (a.v != a.v ? a.v : b.v);
}

// The larger of |a| and b, or NaN as soon as one is NaN.
KOKKOS_INLINE_FUNCTION double maxMagnitude(double a, double b) {
  const double m = std::fabs(a);
  return m <= b ? b : (b != b ? b : m); // NaN m: kept, comparisons fail
}
template <int W>
inline PackOf<W> maxMagnitude(const PackOf<W>& a, const PackOf<W>& b) {
  const typename PackOf<W>::vector m = a.v < 0.0 ? -a.v : a.v;
  return m <= b.v ? b.v : (b.v != b.v ? b.v : m);
}

// max(a, 0); NaN stays.
KOKKOS_INLINE_FUNCTION double positivePart(double a) {
  return a < 0 ? 0.0 : a;
}
template <int W>
inline PackOf<W> positivePart(const PackOf<W>& a) {
  return a.v < 0.0 ? typename PackOf<W>::vector{} : a.v;
}

KOKKOS_INLINE_FUNCTION double squareRoot(double a) {
  return std::sqrt(a);
}
template <int W>
inline PackOf<W> squareRoot(const PackOf<W>& a) {
  PackOf<W> root;
  for (int lane = 0; lane < W; ++lane)
    root.v[lane] = __builtin_sqrt(a.v[lane]);
  return root;
}

// Nearest integers, ties to even; 0 beyond the fixed-point range and for NaN (that element is dropped and reported).
KOKKOS_INLINE_FUNCTION std::int64_t toFixed(double quanta) {
  return roundToFixed(quanta);
}
template <int W>
inline IntPackOf<W> toFixed(const PackOf<W>& quanta) {
  typename PackOf<W>::vector rounded;
  for (int lane = 0; lane < W; ++lane)
    rounded[lane] = __builtin_rint(quanta.v[lane]);
  rounded = rounded < fixed_point_limit && rounded > -fixed_point_limit
                ? rounded
                : typename PackOf<W>::vector{};
  return __builtin_convertvector(rounded, typename IntPackOf<W>::vector);
}

KOKKOS_INLINE_FUNCTION double laneOf(double a, int) {
  return a;
}
KOKKOS_INLINE_FUNCTION std::int64_t laneOf(std::int64_t a, int) {
  return a;
}
template <int W>
inline double laneOf(const PackOf<W>& a, int lane) {
  return a.v[lane];
}
template <int W>
inline std::int64_t laneOf(const IntPackOf<W>& a, int lane) {
  return a.v[lane];
}

KOKKOS_INLINE_FUNCTION void setLane(double& a, int, double value) {
  a = value;
}
template <int W>
inline void setLane(PackOf<W>& a, int lane, double value) {
  a.v[lane] = value;
}

// The scalar type of the element kernels for W lanes, and its integers.
template <int W>
struct LanesOf {
  using real = PackOf<W>;
  using integer = IntPackOf<W>;
};
template <>
struct LanesOf<1> {
  using real = double;
  using integer = std::int64_t;
};
template <class Real>
struct NumLanes {
  static constexpr int value = 1;
};
template <int W>
struct NumLanes<PackOf<W>> {
  static constexpr int value = W;
};
using Lanes = LanesOf<simd_width>::real;
using IntLanes = LanesOf<simd_width>::integer;

} // namespace brickwall::mechanics
