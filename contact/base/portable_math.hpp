// Elementary functions from + - * / and powers of two only. Mathematical libraries differ in the
// last bits between machines and between host and device; these functions do not, so that results
// agree bit for bit on CPUs and GPUs (provided that the compiler fuses no multiplications with
// additions, which the build ensures). Errors are below 4 ulp, as tested.
#pragma once

#include "contact/base/backend.hpp"

#include <cmath>

namespace brickwall {

// ln(1 + d). NaN for d < -1, -inf for d = -1.
KOKKOS_INLINE_FUNCTION double portableLog1p(double d) {
  constexpr double ln2_high = 6.93147180369123816490e-01, ln2_low = 1.90821492927058770002e-10;
  double exponent = 0;
  if (!(std::fabs(d) <= 0.29)) { // 1 + d = 2^exponent m with m in [sqrt(1/2), sqrt(2))
    if (!(d > -1))
      return d == -1 ? -HUGE_VAL : static_cast<double>(NAN);
    if (d > 1.7e308)
      return d;
    int e = 0;
    double m = std::frexp(1 + d, &e);
    if (m < 0.70710678118654752) {
      m *= 2;
      --e;
    }
    exponent = e;
    d = m - 1;
  }
  // 2 artanh(z) with z = d/(2 + d): |z| <= 0.172, so the first term left out is below 1e-18 of the
  // sum.
  const double z = d / (2 + d), w = z * z;
  double series = 1.0 / 23;
  for (int odd = 21; odd >= 3; odd -= 2)
    series = series * w + 1.0 / odd;
  const double logarithm = 2 * z + 2 * z * (w * series);
  return exponent * ln2_high + (exponent * ln2_low + logarithm);
}

// e^x.
KOKKOS_INLINE_FUNCTION double portableExp(double x) {
  constexpr double ln2_high = 6.93147180369123816490e-01, ln2_low = 1.90821492927058770002e-10;
  if (!(x > -745.2))
    return x == x ? 0 : x;
  if (x > 709.8)
    return HUGE_VAL;
  const double k = std::rint(x * 1.44269504088896340736);
  const double r = (x - k * ln2_high) - k * ln2_low; // |r| <= ln(2)/2
  double series = 1;
  for (int n = 14; n >= 1; --n) // Taylor: the first term left out is below 1e-19
    series = 1 + series * (r * (1.0 / n));
  return std::ldexp(series, static_cast<int>(k));
}

// (1 - sin(y)/y) 6/y^2 for |y| <= pi/2, from y^2: Taylor, the first term left out is below 1e-20.
KOKKOS_INLINE_FUNCTION double portableSineTail(double y_squared) {
  double series = 1;
  for (int n = 22; n >= 4; n -= 2)
    series = 1 - series * (y_squared * (1.0 / (n * (n + 1))));
  return series;
}

// sin(pi s) for 0 <= s <= 1, symmetric about 1/2 to the last bit.
KOKKOS_INLINE_FUNCTION double portableSinPi(double s) {
  const double y = 3.14159265358979323846 * (s <= 0.5 ? s : 1 - s), w = y * y;
  return y * (1 - portableSineTail(w) * (w / 6));
}

// 1 - sin(pi s)/(pi s) for 0 <= s <= 1, without cancellation.
KOKKOS_INLINE_FUNCTION double portableOneMinusSincPi(double s) {
  const double y = 3.14159265358979323846 * s, w = y * y;
  return s <= 0.5 ? portableSineTail(w) * (w / 6) : 1 - portableSinPi(s) / y;
}

} // namespace brickwall
