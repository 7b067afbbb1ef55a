// Vectors of any scalar type: for one point, or for as many as a pack has lanes.
#pragma once

#include "contact/base/pack.hpp"
#include "contact/base/vec3.hpp"

namespace brickwall {

// Vec3 of any scalar type.
template <class Real>
struct Triple {
  Real x, y, z;

  KOKKOS_INLINE_FUNCTION friend Triple operator+(const Triple& a, const Triple& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  KOKKOS_INLINE_FUNCTION friend Triple operator-(const Triple& a, const Triple& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  KOKKOS_INLINE_FUNCTION friend Triple operator-(const Triple& a) { return {-a.x, -a.y, -a.z}; }
  KOKKOS_INLINE_FUNCTION friend Triple operator*(const Real& s, const Triple& a) {
    return {s * a.x, s * a.y, s * a.z};
  }
  KOKKOS_INLINE_FUNCTION friend Triple where(const typename MaskOf<Real>::type& mask,
                                             const Triple& a, const Triple& b) {
    return {where(mask, a.x, b.x), where(mask, a.y, b.y), where(mask, a.z, b.z)};
  }
  KOKKOS_INLINE_FUNCTION friend Real dot(const Triple& a, const Triple& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }
  KOKKOS_INLINE_FUNCTION friend Triple cross(const Triple& a, const Triple& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
};
KOKKOS_INLINE_FUNCTION Triple<double> triple(const Vec3& a) {
  return {a.x, a.y, a.z};
}

} // namespace brickwall
