// Plain arrays [lane] from which packs are loaded and to which they are stored: for numbers that
// are gathered point by point, processed in lanes, and read again one by one.
#pragma once

#include "contact/base/triple.hpp"

#include <cstring>

namespace brickwall {

template <class Real>
KOKKOS_INLINE_FUNCTION Real loadLanes(const double* from) {
  Real lanes;
  memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
template <class Real, int width>
KOKKOS_INLINE_FUNCTION Triple<Real> loadTriple(const double (&from)[3][width]) {
  return {loadLanes<Real>(from[0]), loadLanes<Real>(from[1]), loadLanes<Real>(from[2])};
}
template <class Lanes, class Number>
KOKKOS_INLINE_FUNCTION void storeLanes(const Lanes& lanes, Number* to) {
  memcpy(to, &lanes, sizeof lanes);
}
template <class Real, int width>
KOKKOS_INLINE_FUNCTION void storeTriple(const Triple<Real>& lanes, double (&to)[3][width]) {
  storeLanes(lanes.x, to[0]);
  storeLanes(lanes.y, to[1]);
  storeLanes(lanes.z, to[2]);
}

} // namespace brickwall
