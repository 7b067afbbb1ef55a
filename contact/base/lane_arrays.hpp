// Plain arrays [lane] from which packs are loaded and to which they are stored: for numbers that
// are gathered point by point, processed in lanes, and read again one by one.
#pragma once

#include "contact/base/triple.hpp"

#include <cstring>

namespace brickwall {

template <class Real, class Number>
KOKKOS_INLINE_FUNCTION Real loadLanes(const Number* from) {
  Real lanes;
  memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
template <class Lanes, class Number>
KOKKOS_INLINE_FUNCTION void storeLanes(const Lanes& lanes, Number* to) {
  memcpy(to, &lanes, sizeof lanes);
}

// A number for each lane: written and read lane by lane with [], and as a whole as a Pack.
template <class Pack, class Number, int width>
struct LaneNumbers {
  Number lane[width];

  KOKKOS_FORCEINLINE_FUNCTION Number& operator[](int l) { return lane[l]; }
  KOKKOS_FORCEINLINE_FUNCTION Number operator[](int l) const { return lane[l]; }
  KOKKOS_FORCEINLINE_FUNCTION operator Pack() const { return loadLanes<Pack>(lane); }
  KOKKOS_FORCEINLINE_FUNCTION LaneNumbers& operator=(const Pack& all) {
    storeLanes(all, lane);
    return *this;
  }
};
template <class Real>
using LaneArray = LaneNumbers<Real, double, NumLanes<Real>::value>;
template <class Real, class Integer>
using LaneIntegers = LaneNumbers<Integer, std::int64_t, NumLanes<Real>::value>;

// A vector for each lane.
template <class Real>
struct LaneTriple {
  LaneArray<Real> x, y, z;

  KOKKOS_FORCEINLINE_FUNCTION void set(int lane, const Vec3& a) {
    x[lane] = a.x;
    y[lane] = a.y;
    z[lane] = a.z;
  }
  KOKKOS_FORCEINLINE_FUNCTION Vec3 of(int lane) const { return {x[lane], y[lane], z[lane]}; }
  KOKKOS_FORCEINLINE_FUNCTION operator Triple<Real>() const { return {x, y, z}; }
  KOKKOS_FORCEINLINE_FUNCTION LaneTriple& operator=(const Triple<Real>& all) {
    x = all.x;
    y = all.y;
    z = all.z;
    return *this;
  }
};

} // namespace brickwall
