// Several doubles in SIMD lanes. Point-wise functions are templates on the scalar type: double for
// one point, or a pack for simd_width points at once. The arithmetic of each lane is that of a
// double, so results do not depend on the lane. Packs are host code (GNU vector types: g++, clang);
// devices use double.
#pragma once

#include "contact/base/backend.hpp"

#include <cmath>
#include <utility>

namespace brickwall {

// The vector types of W lanes.
template <int W>
struct VectorsOf {
  typedef double real __attribute__((vector_size(8 * W)));
  typedef std::int64_t integer __attribute__((vector_size(8 * W)));
  typedef std::uint64_t bits __attribute__((vector_size(8 * W)));
  typedef unsigned char bytes __attribute__((vector_size(W)));
};

template <int W>
struct MaskPackOf;

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
  friend PackOf operator+(const PackOf& a, const PackOf& b) { return a.v + b.v; }
  friend PackOf operator-(const PackOf& a, const PackOf& b) { return a.v - b.v; }
  friend PackOf operator*(const PackOf& a, const PackOf& b) { return a.v * b.v; }
  friend PackOf operator/(const PackOf& a, const PackOf& b) { return a.v / b.v; }
  friend PackOf operator-(const PackOf& a) { return -a.v; }
  friend PackOf operator+(const PackOf& a, double b) { return a.v + b; }
  friend PackOf operator+(double a, const PackOf& b) { return a + b.v; }
  friend PackOf operator-(const PackOf& a, double b) { return a.v - b; }
  friend PackOf operator*(const PackOf& a, double b) { return a.v * b; }
  friend PackOf operator*(double a, const PackOf& b) { return a * b.v; }
  friend PackOf operator/(double a, const PackOf& b) { return a / b.v; }
  friend PackOf operator/(const PackOf& a, double b) { return a.v / b; }
  friend MaskPackOf<W> operator<(const PackOf& a, const PackOf& b) { return a.v < b.v; }
  friend MaskPackOf<W> operator<=(const PackOf& a, const PackOf& b) { return a.v <= b.v; }
  friend MaskPackOf<W> operator>(const PackOf& a, const PackOf& b) { return a.v > b.v; }
  friend MaskPackOf<W> operator==(const PackOf& a, const PackOf& b) { return a.v == b.v; }
};

// Integers in the same lanes; sums wrap around.
template <int W>
struct IntPackOf {
  using vector = typename VectorsOf<W>::integer;
  using bits = typename VectorsOf<W>::bits;
  vector v;

  IntPackOf() = default;
  IntPackOf(vector x) : v(x) {}
  std::int64_t operator[](int lane) const { return v[lane]; }
  friend IntPackOf operator+(const IntPackOf& a, const IntPackOf& b) {
    return (vector)((bits)a.v + (bits)b.v);
  }
  friend IntPackOf operator-(const IntPackOf& a, const IntPackOf& b) {
    return (vector)((bits)a.v - (bits)b.v);
  }
  friend IntPackOf operator-(const IntPackOf& a) { return (vector)(-(bits)a.v); }
};

// The result of a comparison: all bits of a lane are set, or none.
template <int W>
struct MaskPackOf {
  using vector = typename VectorsOf<W>::integer;
  vector v;

  MaskPackOf() = default;
  MaskPackOf(vector x) : v(x) {}
  MaskPackOf(bool x) : v(vector{} - static_cast<std::int64_t>(x)) {}
  friend MaskPackOf operator&(const MaskPackOf& a, const MaskPackOf& b) { return a.v & b.v; }
  friend MaskPackOf operator|(const MaskPackOf& a, const MaskPackOf& b) { return a.v | b.v; }
  friend MaskPackOf operator!(const MaskPackOf& a) { return ~a.v; }
};

// The vector {number(0), ..., number(W - 1)}.
template <int W, class Number, int... lane>
KOKKOS_FORCEINLINE_FUNCTION typename IntPackOf<W>::vector
numbersOfLanes(const Number& number, std::integer_sequence<int, lane...>) {
  return typename IntPackOf<W>::vector{number(lane)...};
}
template <int W, class Number>
KOKKOS_FORCEINLINE_FUNCTION typename IntPackOf<W>::vector numbersOfLanes(const Number& number) {
  return numbersOfLanes<W>(number, std::make_integer_sequence<int, W>());
}

// Whether any lane is not zero.
template <class Integers>
inline bool anyLane(const Integers& mask) {
  std::int64_t any = 0;
  for (unsigned lane = 0; lane < sizeof mask / sizeof any; ++lane)
    any |= mask[lane];
  return any != 0;
}

KOKKOS_INLINE_FUNCTION bool isAny(bool mask) {
  return mask;
}
template <int W>
inline bool isAny(const MaskPackOf<W>& mask) {
  return anyLane(mask.v);
}

// a where the mask is set, otherwise b.
KOKKOS_INLINE_FUNCTION double where(bool mask, double a, double b) {
  return mask ? a : b;
}
template <int W>
inline PackOf<W> where(const MaskPackOf<W>& mask, const PackOf<W>& a, const PackOf<W>& b) {
  using bits = typename MaskPackOf<W>::vector;
  return (typename PackOf<W>::vector)(((bits)a.v & mask.v) | ((bits)b.v & ~mask.v));
}
// a where the mask is set, otherwise 0; the compiler may fold this into the computation of a.
template <int W>
inline PackOf<W> whereOrZero(const MaskPackOf<W>& mask, const PackOf<W>& a) {
  return mask.v != 0 ? a.v : typename PackOf<W>::vector{};
}

// The lanes of a moved up by one; the last lane of `before` becomes the first.
template <int W>
inline IntPackOf<W> shiftedIn(const IntPackOf<W>& before, const IntPackOf<W>& a) {
  return shuffled(before.v, a.v, numbersOfLanes<W>([](int lane) { return W - 1 + lane; }));
}

// The smaller of the two, or NaN if one is NaN.
KOKKOS_INLINE_FUNCTION double minOrNan(double a, double b) {
  return a < b ? a : (a != a ? a : b);
}
template <int W>
inline PackOf<W> minOrNan(const PackOf<W>& a, const PackOf<W>& b) {
  return a.v < b.v ? a.v : (a.v != a.v ? a.v : b.v);
}

// The larger of |a| and b >= 0, or NaN if one is NaN.
KOKKOS_INLINE_FUNCTION double maxMagnitude(double a, double b) {
  const double m = std::fabs(a);
  return m <= b ? b : (b != b ? b : m); // NaN m: kept, comparisons fail
}
// The bit patterns of magnitudes have the order of the numbers, with NaN above all.
template <int W>
inline PackOf<W> maxMagnitude(const PackOf<W>& a, const PackOf<W>& b) {
  using integer = typename IntPackOf<W>::vector;
  const integer m = (integer)a.v & INT64_MAX, n = (integer)b.v;
  return (typename PackOf<W>::vector)(m > n ? m : n);
}

// Whether |a| <= limit is false in any lane.
template <int W>
inline bool anyBeyond(const PackOf<W>& a, double limit) {
  const typename PackOf<W>::vector m = a.v < 0.0 ? -a.v : a.v;
  return anyLane(~(m <= limit));
}

// Whether |a| < limit.
template <int W>
inline MaskPackOf<W> isWithin(const PackOf<W>& a, double limit) {
  return typename MaskPackOf<W>::vector((a.v < limit) & (a.v > -limit));
}

// max(a, 0); NaN remains NaN.
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

KOKKOS_INLINE_FUNCTION double magnitude(double a) {
  return std::fabs(a);
}
template <int W>
inline PackOf<W> magnitude(const PackOf<W>& a) {
  return (typename PackOf<W>::vector)((typename IntPackOf<W>::vector)a.v & INT64_MAX);
}
template <int W>
inline PackOf<W> maxOf(const PackOf<W>& a, const PackOf<W>& b) {
  return where(a < b, b, a);
}

template <int W>
inline PackOf<W> minOf(const PackOf<W>& a, const PackOf<W>& b) {
  return where(b < a, b, a);
}

// a where m != 0, otherwise 0.
KOKKOS_INLINE_FUNCTION double whereNotZero(double m, double a) {
  return m != 0 ? a : 0.0;
}
template <int W>
inline PackOf<W> whereNotZero(const PackOf<W>& m, const PackOf<W>& a) {
  return m.v != 0.0 ? a.v : typename PackOf<W>::vector{};
}

// The mask of the first `count` lanes.
template <int W>
inline MaskPackOf<W> firstLanes(int count) {
  typename IntPackOf<W>::vector lane;
  for (int l = 0; l < W; ++l)
    lane[l] = l;
  return lane < count;
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

template <int W>
inline PackOf<W> toReal(const IntPackOf<W>& a) {
  return __builtin_convertvector(a.v, typename PackOf<W>::vector);
}
KOKKOS_INLINE_FUNCTION double toReal(std::int64_t a) {
  return static_cast<double>(a);
}

// The scalar type for W points at once, and its integers. On devices W is 1, and no vector type is
// used.
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
template <class Real>
struct MaskOf {
  using type = bool;
};
template <int W>
struct MaskOf<PackOf<W>> {
  using type = MaskPackOf<W>;
};
using Lanes = LanesOf<simd_width>::real;
using IntLanes = LanesOf<simd_width>::integer;

} // namespace brickwall
