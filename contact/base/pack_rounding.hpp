// Rounding of doubles to integers by one addition each, for one point or in lanes.
#pragma once

#include "contact/base/fixed_pack.hpp"
#include "contact/base/lanes.hpp"

#include <cstring>

namespace brickwall {

constexpr std::uint64_t rounding_shift_bits = 0x4338000000000000; // of 1.5 * 2^52

// Rounds many numbers to nearest integers, ties to even, by adding 1.5 * 2^52, and records whether
// all were in [-2^51, 2^51). Host code.
template <int W>
class Rounding {
public:
  static constexpr std::uint64_t shift_bits = rounding_shift_bits;

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

// Rounds numbers as toFixed(). If one is beyond [-2^51, 2^51), `largest` becomes at least the
// largest of their magnitudes; a smaller magnitude is no failure.
template <int N>
KOKKOS_FORCEINLINE_FUNCTION void roundAll(const double (&quanta)[N], double& largest,
                                          std::int64_t (&rounded)[N]) {
  std::uint64_t misfit = 0;
  for (int i = 0; i < N; ++i) {
    const double sum = quanta[i] + 6755399441055744.0;
    std::uint64_t bits;
    memcpy(&bits, &sum, sizeof bits);
    misfit |= bits ^ rounding_shift_bits;
    rounded[i] = static_cast<std::int64_t>(bits - rounding_shift_bits);
  }
  if (misfit >> 52 != 0)
    for (int i = 0; i < N; ++i) {
      largest = maxMagnitude(quanta[i], largest);
      rounded[i] = toFixed(quanta[i]);
    }
}

} // namespace brickwall
