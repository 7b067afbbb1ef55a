// Time histories of loads and prescribed motions as factors of the peak value, and their means over
// steps in closed form, so that the impulse (or displacement) of every pulse is exact for any step;
// zero before the start. theory.md, equation (20).
#pragma once

#include "contact/base/portable_math.hpp"

#include <cmath>

namespace brickwall::mechanics {

// A span of time; an instant if begin = end.
struct TimeSpan {
  double begin = 0, end = 0; // time
};

// T is the duration; the impulse of a unit peak is given in brackets.
enum class PulseKind {
  constant, // 1 at all times, even before 0
  step, // 1 for 0 <= t <= T                                        [T]
  half_sine, // sin(pi t / T) for 0 <= t <= T                            [2 T / pi]
  triangle, // linear rise to 1 at `rise` T, linear fall to 0 at T      [T / 2]
  sin_squared, // sin(pi t / T)^2 for 0 <= t <= T, with a continuous rate       [T / 2]
  // (1 - t/T) exp(-b t/T) for 0 <= t <= T (positive phase)   [T (1/b - (1 - exp(-b))/b^2)]
  friedlander,
};

struct PulseShape {
  PulseKind kind = PulseKind::constant;
  double duration = HUGE_VAL; // T, time; only `constant` and `step` may be infinite
  double rise = 0.5; // triangle: fraction of T, in [0, 1]
  double decay = 1.0; // friedlander: b >= 0

  // Factors of a mean that depend on the width w T of its span alone: half_sine sinc(pi w/2);
  // sin_squared (1 - sinc(pi w))/2; friedlander phi_1 = (1 - exp(-b w))/(b w) and phi_2 = (1 -
  // phi_1)/(b w).
  struct Width {
    double first = 1, second = 0;
  };
  KOKKOS_INLINE_FUNCTION Width ofWidth(double w) const {
    switch (kind) {
    case PulseKind::half_sine:
      return {1 - portableOneMinusSincPi(0.5 * w), 0};
    case PulseKind::sin_squared:
      return {0.5 * portableOneMinusSincPi(w), 0};
    case PulseKind::friedlander:
      return ofDecay(decay * w);
    default:
      return {};
    }
  }
  // The factors of all spans of this length that lie within the pulse.
  KOKKOS_INLINE_FUNCTION Width ofWidth(const TimeSpan& span) const {
    return ofWidth(minOf((span.end - span.begin) / duration, 1.0));
  }

  // Mean factor over a span relative to the start, or the factor at an instant; the error is a few
  // ulp of 1.
  KOKKOS_INLINE_FUNCTION double mean(const TimeSpan& span) const {
    return mean(span, ofWidth(span));
  }
  // The same with ofWidth(span) given.
  KOKKOS_INLINE_FUNCTION double mean(const TimeSpan& span, const Width& whole) const {
    if (kind == PulseKind::constant)
      return 1;
    const double a = maxOf(span.begin, 0.0), b = minOf(span.end, duration);
    if (!(a <= b))
      return 0;
    const double share = span.begin < span.end ? (b - a) / (span.end - span.begin) : 1;
    if (kind == PulseKind::step)
      return share;
    const bool is_whole = a == span.begin && b == span.end;
    return share *
           meanWithin(a / duration, b / duration, is_whole ? whole : ofWidth((b - a) / duration));
  }

private:
  // Mean over a <= t/T <= b, both in [0, 1]; no sum cancels.
  KOKKOS_INLINE_FUNCTION double meanWithin(double a, double b, const Width& width) const {
    switch (kind) {
    case PulseKind::half_sine:
      return portableSinPi(0.5 * (a + b)) * width.first;
    case PulseKind::sin_squared: { // sin^2 + cos(2 pi m) (1 - sinc(pi w))/2 about the midpoint m
      const double sine = portableSinPi(0.5 * (a + b)), square = sine * sine;
      return square + (1 - 2 * square) * width.first;
    }
    case PulseKind::triangle:
      return triangleMean(a, b);
    default: // friedlander
      return portableExp(-decay * a) * ((1 - b) * width.first + (b - a) * width.second);
    }
  }
  KOKKOS_INLINE_FUNCTION double triangleMean(double a, double b) const {
    if (b <= rise && rise > 0)
      return 0.5 * (a + b) / rise;
    if (a >= rise)
      return (1 - 0.5 * (a + b)) / (1 - rise);
    const double left = 0.5 * (a / rise + 1), right = 0.5 * (1 + (1 - b) / (1 - rise));
    return ((rise - a) * left + (b - rise) * right) / (b - a);
  }
  // phi_1 and phi_2 of y = b w. The series is used where the closed form would cancel; its first
  // neglected term is below 1e-18.
  KOKKOS_INLINE_FUNCTION static Width ofDecay(double y) {
    if (y >= 1) {
      const double first = (1 - portableExp(-y)) / y;
      return {first, (1 - first) / y};
    }
    double series = 1;
    for (int n = 19; n >= 3; --n)
      series = 1 - series * (y / n);
    return {1 - y * (0.5 * series), 0.5 * series};
  }
};

} // namespace brickwall::mechanics
