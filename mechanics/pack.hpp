// SIMD lanes of doubles: the element functions are templates on the scalar type, double for one element or Pack for
// simd_width elements at once. Each lane's arithmetic is that of a double, so results do not depend on the
// lane. Host code only; GNU vector types (g++, clang).
#pragma once

#include "contact/base/backend.hpp"
#include "contact/base/fixed_point.hpp"

#include <cmath>
#include <cstring>
#include <type_traits>

namespace brickwall::mechanics {

// The vector types of W lanes (g++ takes no template argument in the attribute).
template <int W>
struct VectorsOf;
template <>
struct VectorsOf<8> {
  typedef double real __attribute__((vector_size(64)));
  typedef std::int64_t integer __attribute__((vector_size(64)));
  typedef std::uint64_t bits __attribute__((vector_size(64)));
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

// Lanes of a and b together by number: 0 .. W-1 are a's, W .. 2W-1 b's.
template <class V, class Numbers>
KOKKOS_FORCEINLINE_FUNCTION V shuffled(const V& a, const V& b, const Numbers& lanes) {
  return __builtin_shuffle(a, b, lanes);
}

// Whether a lane is not zero.
template <class Integers>
inline bool anyLane(const Integers& mask) {
  std::int64_t any = 0;
  for (unsigned lane = 0; lane < sizeof mask / sizeof any; ++lane)
    any |= mask[lane];
  return any != 0;
}

// Lanes moved up by one, the last of `before` coming in below.
template <int W>
inline IntPackOf<W> shiftedIn(const IntPackOf<W>& before, const IntPackOf<W>& a) {
  static_assert(W == 8);
  using I = typename IntPackOf<W>::vector;
  return shuffled(before.v, a.v, I{7, 8, 9, 10, 11, 12, 13, 14});
}

// Whether all are > 0.
template <int W>
inline bool allPositive(const PackOf<W>& a) {
  return !anyLane(~(a.v > 0.0));
}

// The smaller, or NaN as soon as one is NaN.
KOKKOS_INLINE_FUNCTION double minOrNan(double a, double b) {
  return a < b ? a : (a != a ? a : b);
}
template <int W>
inline PackOf<W> minOrNan(const PackOf<W>& a, const PackOf<W>& b) {
  return a.v < b.v ? a.v : (a.v != a.v ? a.v : b.v);
}

// The larger of |a| and b >= 0, or NaN as soon as one is NaN.
KOKKOS_INLINE_FUNCTION double maxMagnitude(double a, double b) {
  const double m = std::fabs(a);
  return m <= b ? b : (b != b ? b : m); // NaN m: kept, comparisons fail
}
// Bit patterns of magnitudes have the order of the numbers, NaN above all.
template <int W>
inline PackOf<W> maxMagnitude(const PackOf<W>& a, const PackOf<W>& b) {
  using integer = typename IntPackOf<W>::vector;
  const integer m = (integer)a.v & INT64_MAX, n = (integer)b.v;
  return (typename PackOf<W>::vector)(m > n ? m : n);
}

// Whether |a| <= limit is false in a lane.
template <int W>
inline bool anyBeyond(const PackOf<W>& a, double limit) {
  const typename PackOf<W>::vector m = a.v < 0.0 ? -a.v : a.v;
  return anyLane(~(m <= limit));
}

// -1 in the lanes where |a| < limit, else 0.
template <int W>
inline IntPackOf<W> isWithin(const PackOf<W>& a, double limit) {
  return typename IntPackOf<W>::vector((a.v < limit) & (a.v > -limit));
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

// a where m != 0, else 0.
KOKKOS_INLINE_FUNCTION double whereNotZero(double m, double a) {
  return m != 0 ? a : 0.0;
}
template <int W>
inline PackOf<W> whereNotZero(const PackOf<W>& m, const PackOf<W>& a) {
  return m.v != 0.0 ? a.v : typename PackOf<W>::vector{};
}

// The mask of the first `count` lanes: -1 there, else 0.
template <int W>
inline IntPackOf<W> firstLanes(int count) {
  typename IntPackOf<W>::vector lane;
  for (int l = 0; l < W; ++l)
    lane[l] = l;
  return lane < count;
}

// a where the mask has all bits, 0 where it has none.
template <int W>
inline PackOf<W> masked(const PackOf<W>& a, const IntPackOf<W>& mask) {
  return mask.v != 0 ? a.v : typename PackOf<W>::vector{};
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

// Rounds many numbers to nearest integers, ties to even, by adding 1.5 * 2^52, and remembers whether all were in [-2^51, 2^51).
template <int W>
class Rounding {
public:
  static constexpr std::uint64_t shift_bits = 0x4338000000000000;

  // The integer and shift(), modulo 2^64.
  KOKKOS_FORCEINLINE_FUNCTION IntPackOf<W> shifted(const PackOf<W>& a) {
    const bits sum = (bits)(a.v + 6755399441055744.0);
    _misfit |= sum ^ shift_bits;
    return (typename IntPackOf<W>::vector)sum;
  }
  static IntPackOf<W> shift() { return (typename IntPackOf<W>::vector)(bits{} + shift_bits); }
  // Counts as if a number had not fitted where this is false (0 in a lane).
  KOKKOS_FORCEINLINE_FUNCTION void need(const IntPackOf<W>& condition) {
    _misfit |= (bits)~condition.v;
  }
  KOKKOS_FORCEINLINE_FUNCTION bool isGood() const { return !anyLane(_misfit >> 52); }

private:
  using bits = typename VectorsOf<W>::bits;
  bits _misfit = {};
};

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

// W numbers from and to memory.
template <class Pack, class Number>
inline Pack loadPack(const Number* from) {
  Pack pack;
  memcpy(&pack.v, from, sizeof pack.v);
  return pack;
}
template <class Pack, class Number>
inline void storePack(const Pack& pack, Number* to) {
  memcpy(to, &pack.v, sizeof pack.v);
}

// W rows of three numbers each, packed, as lanes of x, y and z: `rows(k)` is the k-th of the three packs that they fill.
template <int W, class Rows>
KOKKOS_FORCEINLINE_FUNCTION void triplesOf(const Rows& rows, PackOf<W> (&lanes)[3]) {
  static_assert(W == 8);
  using V = typename PackOf<W>::vector;
  using I = typename IntPackOf<W>::vector;
  const V a = rows(0).v, b = rows(1).v, c = rows(2).v;
  lanes[0].v =
      shuffled(shuffled(a, b, I{0, 3, 6, 9, 12, 15, 0, 0}), c, I{0, 1, 2, 3, 4, 5, 10, 13});
  lanes[1].v =
      shuffled(shuffled(a, b, I{1, 4, 7, 10, 13, 0, 0, 0}), c, I{0, 1, 2, 3, 4, 8, 11, 14});
  lanes[2].v =
      shuffled(shuffled(a, b, I{2, 5, 8, 11, 14, 0, 0, 0}), c, I{0, 1, 2, 3, 4, 9, 12, 15});
}
template <int W>
KOKKOS_FORCEINLINE_FUNCTION void storeTriples(const PackOf<W> (&lanes)[3], double* rows) {
  static_assert(W == 8);
  using I = typename IntPackOf<W>::vector;
  const auto &x = lanes[0].v, &y = lanes[1].v, &z = lanes[2].v;
  const auto a = shuffled(shuffled(x, y, I{0, 8, 0, 1, 9, 0, 2, 10}), z, I{0, 1, 8, 3, 4, 9, 6, 7});
  const auto b =
      shuffled(shuffled(x, y, I{0, 3, 11, 0, 4, 12, 0, 5}), z, I{10, 1, 2, 11, 4, 5, 12, 7});
  const auto c =
      shuffled(shuffled(x, y, I{13, 0, 6, 14, 0, 7, 15, 0}), z, I{0, 13, 2, 3, 14, 5, 6, 15});
  memcpy(rows, &a, sizeof a);
  memcpy(rows + 8, &b, sizeof b);
  memcpy(rows + 16, &c, sizeof c);
}

// Asks the processor for a line of memory. (g++ 12 drops calls of a function that does only this, unless they are inlined
// early.)
__attribute__((always_inline)) inline void prefetchLine(const double* address) {
  __builtin_prefetch(address);
}

// The same into the second-level cache only.
__attribute__((always_inline)) inline void prefetchFarLine(const double* address) {
  __builtin_prefetch(address, 0, 2);
}

// The first `count` <= W of them, then zeros.
template <class Pack, class Number>
KOKKOS_FORCEINLINE_FUNCTION Pack loadSome(const Number* from, int count) {
  Pack pack = {};
  if (count >= static_cast<int>(sizeof pack.v / sizeof(Number)))
    return loadPack<Pack>(from);
  memcpy(&pack.v, from, sizeof(Number) * count);
  return pack;
}

// Rows of three numbers of `count` <= W nodes; the other lanes are zero. What is copied has its own place in memory, so that
// the lanes of the usual case stay in registers.
template <int W>
KOKKOS_FORCEINLINE_FUNCTION void loadSomeTriples(const double* rows, int count,
                                                 PackOf<W> (&lanes)[3]) {
  if (count >= W) {
    triplesOf([&](int k) { return loadPack<PackOf<W>>(rows + W * k); }, lanes);
  } else {
    double some[3 * W] = {};
    for (int k = 0; k < 3 * count; ++k)
      some[k] = rows[k];
    triplesOf([&](int k) { return loadPack<PackOf<W>>(some + W * k); }, lanes);
  }
}
// Of the sums of two arrays of rows.
template <int W>
KOKKOS_FORCEINLINE_FUNCTION void loadSumOfTriples(const double* a, const double* b, int count,
                                                  PackOf<W> (&lanes)[3]) {
  if (count >= W) {
    triplesOf(
        [&](int k) { return loadPack<PackOf<W>>(a + W * k) + loadPack<PackOf<W>>(b + W * k); },
        lanes);
  } else {
    double some[3 * W] = {};
    for (int k = 0; k < 3 * count; ++k)
      some[k] = a[k] + b[k];
    triplesOf([&](int k) { return loadPack<PackOf<W>>(some + W * k); }, lanes);
  }
}
template <int W>
KOKKOS_FORCEINLINE_FUNCTION void storeSomeTriples(const PackOf<W> (&lanes)[3], int count,
                                                  double* rows) {
  if (count >= W) {
    storeTriples(lanes, rows);
  } else {
    double some[3 * W];
    storeTriples(lanes, some);
    for (int k = 0; k < 3 * count; ++k)
      rows[k] = some[k];
  }
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
