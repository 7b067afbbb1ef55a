// Time shapes of loads and prescribed motions, as factors of the peak value; zero before the start.
#pragma once

#include "contact/base/portable_math.hpp"

#include <cmath>

namespace brickwall::mechanics {

// T is the duration; impulse of a unit peak in brackets.
enum class PulseKind {
  constant, // 1 at all times, even before 0
  step, // 1 for 0 <= t <= T                                        [T]
  half_sine, // sin(pi t / T) for 0 <= t <= T                            [2 T / pi]
  triangle, // linear rise to 1 at `rise` T, linear fall to 0 at T      [T / 2]
  sin_squared, // sin(pi t / T)^2 for 0 <= t <= T: no jump of the rate      [T / 2]
  friedlander, // (1 - t/T) exp(-b t/T) for 0 <= t <= T (positive phase)   [T (1/b - (1 - exp(-b))/b^2)]
};

struct PulseShape {
  PulseKind kind = PulseKind::constant;
  double duration = HUGE_VAL; // T, time; only `constant` and `step` may have none
  double rise = 0.5; // triangle: fraction of T, in [0, 1]
  double decay = 1.0; // friedlander: b > 0

  // Factor at time t after the start.
  KOKKOS_INLINE_FUNCTION double operator()(double t) const {
    if (kind == PulseKind::constant)
      return 1;
    if (!(t >= 0 && t <= duration))
      return 0;
    const double s = t / duration; // 0 for an endless step
    switch (kind) {
    case PulseKind::half_sine:
      return portableSinPi(s);
    case PulseKind::sin_squared: {
      const double sine = portableSinPi(s);
      return sine * sine;
    }
    case PulseKind::triangle:
      return s < rise ? s / rise : (rise < 1 ? (1 - s) / (1 - rise) : 1);
    case PulseKind::friedlander:
      return (1 - s) * portableExp(-decay * s);
    default:
      return 1;
    }
  }
};

} // namespace brickwall::mechanics
