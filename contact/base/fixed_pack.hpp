// Conversion of doubles to integers, for one point or in lanes: forces in quanta.
#pragma once

#include "contact/base/fixed_point.hpp"
#include "contact/base/pack.hpp"

namespace brickwall {

// Whether values are small enough for a contribution; false for NaN.
template <int W>
inline MaskPackOf<W> fitsFixedPoint(const PackOf<W>& quanta) {
  return magnitude(quanta) < PackOf<W>(fixed_point_limit);
}

// Nearest integers, ties to even; 0 beyond the fixed-point range and for NaN (fitsFixedPoint()
// distinguishes these).
KOKKOS_INLINE_FUNCTION std::int64_t toFixed(double quanta) {
  return roundToFixed(quanta);
}
template <int W>
inline IntPackOf<W> toFixed(const PackOf<W>& quanta) {
  typename PackOf<W>::vector rounded = quanta.v;
  for (int lane = 0; lane < W; ++lane)
    rounded[lane] = __builtin_rint(rounded[lane]);
  rounded = rounded < fixed_point_limit && rounded > -fixed_point_limit
                ? rounded
                : typename PackOf<W>::vector{};
  return __builtin_convertvector(rounded, typename IntPackOf<W>::vector);
}

} // namespace brickwall
