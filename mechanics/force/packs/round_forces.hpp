// Rounding of modal forces and their sums at the corners, theory.md, equation (23).
#pragma once

#include "contact/base/pack_rounding.hpp"
#include "mechanics/element/hex8_modes.hpp"

namespace brickwall::mechanics {

// Corner forces of one element and one force kind: [xyz][corner] in quanta.
template <class Integer>
struct CornerForces {
  Integer value[3][8];
};

template <class Real, class Integer, int N>
KOKKOS_FORCEINLINE_FUNCTION void roundModes(const Real (&modes)[N], Real& largest,
                                            Integer (&rounded)[N]) {
  for (int m = 0; m < N; ++m) {
    largest = maxMagnitude(modes[m], largest);
    rounded[m] = toFixed(modes[m]);
  }
}
template <int N>
KOKKOS_FORCEINLINE_FUNCTION void roundModes(const double (&modes)[N], double& largest,
                                            std::int64_t (&rounded)[N]) {
  roundAll(modes, largest, rounded);
}

template <class Real, class Integer>
KOKKOS_INLINE_FUNCTION void roundToCorners(const Real (&modes)[3][num_modes], Real& largest,
                                           CornerForces<Integer>& corners) {
  for (int i = 0; i < 3; ++i) {
    Integer rounded[num_modes];
    roundModes(modes[i], largest, rounded);
    modesToCorners(rounded, corners.value[i]);
  }
}
template <class Real, class Integer>
KOKKOS_INLINE_FUNCTION void roundToCorners(const Real (&modes)[3][3], Real& largest,
                                           CornerForces<Integer>& corners) {
  for (int i = 0; i < 3; ++i) {
    Integer rounded[3];
    roundModes(modes[i], largest, rounded);
    linearModesToCorners(rounded, corners.value[i]);
  }
}

} // namespace brickwall::mechanics
