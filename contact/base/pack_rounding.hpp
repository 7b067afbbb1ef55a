// Rounding of packs of doubles to packs of integers by one addition each. Host code.
#pragma once

#include "contact/base/fixed_pack.hpp"
#include "contact/base/lanes.hpp"

namespace brickwall {

// Rounds many numbers to nearest integers, ties to even, by adding 1.5 * 2^52, and records whether
// all were in [-2^51, 2^51).
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
  // Records a misfit where the condition is false.
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

} // namespace brickwall
