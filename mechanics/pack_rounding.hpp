// Packs of doubles to packs of integers: forces in quanta. Host code but for roundToFixed's.
#pragma once

#include "contact/base/fixed_point.hpp"
#include "contact/base/lanes.hpp"
#include "contact/base/pack.hpp"

namespace brickwall::mechanics {

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
  // Counts as if a number had not fitted where this is false.
  KOKKOS_FORCEINLINE_FUNCTION void need(const MaskPackOf<W>& condition) {
    _misfit |= (bits)~condition.v;
  }
  KOKKOS_FORCEINLINE_FUNCTION bool isGood() const {
    const bits exponents = _misfit >> 52;
    std::uint64_t lanes[W];
    __builtin_memcpy(lanes, &exponents, sizeof lanes);
    return !anyBitIn(lanes);
  }

private:
  using bits = typename VectorsOf<W>::bits;
  bits _misfit = {};
};

} // namespace brickwall::mechanics
