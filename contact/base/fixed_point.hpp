// Order-free sums: forces in 64-bit fixed point, energies and momenta in three 64-bit limbs.
// Integer addition is associative, so the result does not depend on threads, ranks or message
// order.
#pragma once

#include "contact/base/backend.hpp"

#include <cmath>
#include <cstdint>

namespace brickwall {

// The least e with x <= 2^e, x > 0; exact, unlike the logarithm.
inline int exponentAbove(double x) {
  int exponent = 0;
  const double mantissa = std::frexp(x, &exponent); // [1/2, 1)
  return mantissa > 0.5 ? exponent : exponent - 1;
}

// A power of two: one unit of a fixed-point force, in units of force.
struct Quantum {
  double value = 1;
  double inverse = 1;
  static Quantum powerOfTwo(int exponent) {
    return {std::ldexp(1.0, exponent), std::ldexp(1.0, -exponent)};
  }
  // The quantum 2^(ceil(log2 F) - 54) for the largest force scale F > 0.
  static Quantum forForceScale(double largest_force) {
    return powerOfTwo(exponentAbove(largest_force) - 54);
  }
};

// Single contributions must stay below this many quanta, so that sums of up to 64 of them fit 64
// bits.
constexpr double fixed_point_limit = 72057594037927936.0; // 2^56

// False for values too large for a contribution, and for NaN.
KOKKOS_INLINE_FUNCTION bool fitsFixedPoint(double quanta) {
  return std::fabs(quanta) < fixed_point_limit;
}

// Rounds to the nearest integer, ties to even. Needs fitsFixedPoint(quanta); other values become 0,
// so that the conversion is defined; the caller counts and reports them.
KOKKOS_INLINE_FUNCTION std::int64_t roundToFixed(double quanta) {
  return fitsFixedPoint(quanta) ? static_cast<std::int64_t>(std::rint(quanta)) : 0;
}

// Scale of a sum in limbs: terms are below `largest` in magnitude, up to 2^28 of them are added
// without overflow, and each is kept to largest * 2^-102, so `largest` may be chosen generously
// from input data.
struct LimbScale {
  double high_quantum = 1, high_inverse = 1;
  double low_quantum = 1, low_inverse = 1;
  double tail_quantum = 1, tail_inverse = 1;
  static LimbScale forLargest(double largest) {
    const int e = largest > 0 ? exponentAbove(largest) : 0;
    return {std::ldexp(1.0, e - 34), std::ldexp(1.0, 34 - e),  std::ldexp(1.0, e - 68),
            std::ldexp(1.0, 68 - e), std::ldexp(1.0, e - 102), std::ldexp(1.0, 102 - e)};
  }
};

// One sum in limbs, value = high * high_quantum + low * low_quantum + tail * tail_quantum. Terms
// beyond the scale (or NaN) are not added but counted in LimbSums::invalid.
struct LimbSum {
  std::int64_t high = 0;
  std::int64_t low = 0;
  std::int64_t tail = 0;

  // Returns false, adding nothing, when the term does not fit the scale.
  KOKKOS_INLINE_FUNCTION bool add(double term, const LimbScale& scale) {
    const double high_part = std::rint(term * scale.high_inverse);
    if (!(std::fabs(high_part) < 17179869184.0)) // 2^34
      return false;
    const double rest = term - high_part * scale.high_quantum; // exact: multiples of ulp(term)
    const double low_part = std::rint(rest * scale.low_inverse);
    high += static_cast<std::int64_t>(high_part);
    low += static_cast<std::int64_t>(low_part);
    tail += static_cast<std::int64_t>(
        std::rint((rest - low_part * scale.low_quantum) * scale.tail_inverse));
    return true;
  }
  KOKKOS_INLINE_FUNCTION LimbSum& operator+=(const LimbSum& b) {
    high += b.high;
    low += b.low;
    tail += b.tail;
    return *this;
  }
  // Normalises low and tail to [-2^33, 2^33), so that equal sums have equal limbs. To be called
  // before more than 2^28 terms are added.
  KOKKOS_INLINE_FUNCTION void carry() {
    constexpr std::int64_t half = std::int64_t(1) << 33;
    const std::int64_t from_tail = (tail + half) >> 34;
    tail -= from_tail * (2 * half);
    low += from_tail;
    const std::int64_t from_low = (low + half) >> 34;
    low -= from_low * (2 * half);
    high += from_low;
  }
  double value(const LimbScale& scale) const {
    // Carrying first makes the result the double nearest to the exact sum but for two roundings.
    LimbSum sum = *this;
    sum.carry();
    return static_cast<double>(sum.high) * scale.high_quantum +
           (static_cast<double>(sum.low) * scale.low_quantum +
            static_cast<double>(sum.tail) * scale.tail_quantum);
  }
};

// N sums that are reduced together: Kokkos reduces it with PlusReducer<LimbSums<N>>, MPI as 3 N + 1
// int64.
template <int N>
struct LimbSums {
  LimbSum sum[N];
  std::int64_t invalid = 0; // terms that did not fit

  KOKKOS_INLINE_FUNCTION void add(int i, double term, const LimbScale& scale) {
    if (!sum[i].add(term, scale))
      ++invalid;
  }
  KOKKOS_INLINE_FUNCTION void add(int i, const LimbSum& part) { sum[i] += part; }
  KOKKOS_INLINE_FUNCTION LimbSums& operator+=(const LimbSums& b) {
    for (int i = 0; i < N; ++i)
      sum[i] += b.sum[i];
    invalid += b.invalid;
    return *this;
  }
  KOKKOS_INLINE_FUNCTION void carry() {
    for (int i = 0; i < N; ++i)
      sum[i].carry();
  }
  std::int64_t* data() { return reinterpret_cast<std::int64_t*>(this); }
  static constexpr int size() { return 3 * N + 1; }
};

} // namespace brickwall
