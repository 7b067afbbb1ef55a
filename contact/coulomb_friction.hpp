// Coulomb friction by return mapping: an elastic spring along the face holds until its force reaches mu F_n, then slips at
// that force. Point-wise.
#pragma once

#include "contact/base/vec3.hpp"

namespace brickwall::contact {

// The part of `a` that is perpendicular to the unit vector `normal`.
KOKKOS_INLINE_FUNCTION Vec3 along(const Vec3& a, const Vec3& normal) {
  return a - dot(a, normal) * normal;
}

// A tangential force carried over to a face with another normal: its direction along that face, its magnitude kept, so that
// the energy in the spring stays as it turns with the body. Zero if nothing of it lies along the face.
KOKKOS_INLINE_FUNCTION Vec3 turnedInto(const Vec3& force, const Vec3& normal) {
  const Vec3 flat = along(force, normal);
  const double square = dot(flat, flat);
  return square > 0 ? std::sqrt(dot(force, force) / square) * flat : Vec3();
}

// The trial force, or what is left of it when it exceeds the limit (>= 0).
KOKKOS_INLINE_FUNCTION Vec3 slipped(const Vec3& trial, double limit) {
  const double size = norm(trial);
  return size > limit ? (limit / size) * trial : trial;
}

} // namespace brickwall::contact
