// Coulomb friction by return mapping, eqs. (21) to (23) of theory.md (Simo and Laursen 1992;
// Wriggers 2006). Point-wise.
#pragma once

#include "contact/enforcement/law/contact_history.hpp"

namespace brickwall::contact {

// The tangential part of `a` with respect to the unit vector `normal`.
KOKKOS_INLINE_FUNCTION Vec3 tangentialPart(const Vec3& a, const Vec3& normal) {
  return a - dot(a, normal) * normal;
}

// A tangential force transported to a plane with another normal: projected, with its magnitude
// kept, so that the energy of the spring is kept as it rotates with the body. Zero if the
// projection vanishes.
KOKKOS_INLINE_FUNCTION Vec3 rotateToPlane(const Vec3& force, const Vec3& normal) {
  const Vec3 flat = tangentialPart(force, normal);
  const double square = dot(flat, flat);
  return square > 0 ? std::sqrt(dot(force, force) / square) * flat : Vec3();
}

// P times the dual basis of two tangents: a tangential force t has the components lever . t/P. Zero
// for parallel tangents; eq. (22).
KOKKOS_INLINE_FUNCTION void dualBasis(const Vec3 (&tangent)[2], double P, Vec3 (&lever)[2]) {
  const Vec3 &first = tangent[0], &second = tangent[1];
  const double a = dot(first, first), b = dot(first, second), c = dot(second, second);
  const double determinant = a * c - b * b;
  if (!(determinant > 1e-4 * a * c))
    return;
  const double scale = P / determinant;
  lever[0] = scale * (c * first - b * second);
  lever[1] = scale * (a * second - b * first);
}

// A vector of the plane of `normal`, turned about it by the angle 2 atan(half_turn).
KOKKOS_INLINE_FUNCTION Vec3 turnInPlane(const Vec3& a, const Vec3& normal, double half_turn) {
  const double square = half_turn * half_turn, share = 1 / (1 + square);
  return share * ((1 - square) * a + 2 * half_turn * cross(normal, a));
}

// tan(theta/2) of the angle theta by which a face (or two edges) with these tangents turned about
// its normal in the step that changed them by `motion`: by the mean rotation of its plane, n .
// (a^xi x du,xi + a^eta x du,eta)/4 with the basis at the middle of the step. Exact for rigid
// rotations about the normal; 0 for parallel tangents.
KOKKOS_INLINE_FUNCTION double halfTurnOf(const Vec3 (&tangent)[2], const Vec3 (&motion)[2],
                                         const Vec3& normal) {
  const Vec3 middle[2] = {tangent[0] - 0.5 * motion[0], tangent[1] - 0.5 * motion[1]};
  Vec3 dual[2];
  dualBasis(middle, 1, dual);
  return 0.25 * dot(normal, cross(dual[0], motion[0]) + cross(dual[1], motion[1]));
}

// The tangent of half the angle whose tangent this is.
KOKKOS_INLINE_FUNCTION double halved(double tangent) {
  return tangent / (1 + std::sqrt(1 + tangent * tangent));
}

// Motion that the friction force works on: that of the node, and the normal motion of the face's
// corners, which the balancing forces work on; eq. (23).
KOKKOS_INLINE_FUNCTION Vec3 slipOf(const FrictionSpring& friction, const Vec3& motion,
                                   const Vec3& normal, const Vec3 (&tangent_motion)[2]) {
  return motion - dot(normal, tangent_motion[0]) * friction.lever[0] -
         dot(normal, tangent_motion[1]) * friction.lever[1];
}

// The trial force from that of the last step, `rotated` (R t^n): the slip belongs to the middle of
// the step, so half of the turn follows it; eq. (21).
KOKKOS_INLINE_FUNCTION Vec3 trialForce(const Vec3& rotated, double stiffness, const Vec3& slip,
                                       const Vec3& normal, double half_turn) {
  return rotated - stiffness * turnInPlane(slip, normal, halved(half_turn));
}

// The trial force, scaled down to `limit` (>= 0) where it is larger; eq. (21).
KOKKOS_INLINE_FUNCTION Vec3 returnMap(const Vec3& trial, double limit) {
  const double size = norm(trial);
  return size > limit ? (limit / size) * trial : trial;
}

// Derivatives of a bilinear face's shape functions at the point with these weights. They sum to
// zero.
KOKKOS_INLINE_FUNCTION void shapeDerivatives(const double (&weight)[4], double (&along_xi)[4],
                                             double (&along_eta)[4]) {
  const double bottom = 0.5 * (weight[0] + weight[1]), top = 0.5 * (weight[2] + weight[3]);
  const double left = 0.5 * (weight[0] + weight[3]), right = 0.5 * (weight[1] + weight[2]);
  along_xi[0] = -bottom, along_xi[1] = bottom, along_xi[2] = top, along_xi[3] = -top;
  along_eta[0] = -left, along_eta[1] = -right, along_eta[2] = right, along_eta[3] = left;
}

// Adds the normal forces that balance the couple of the friction force; eq. (22).
KOKKOS_INLINE_FUNCTION void addCouple(const FrictionSpring& friction, const Interaction& pair,
                                      int face_corners, NormalForces& forces) {
  const double q[2] = {dot(friction.lever[0], friction.force),
                       dot(friction.lever[1], friction.force)};
  if (face_corners == 2) {
    forces.on_end -= q[0];
    forces.on_corner[0] += q[1];
    forces.on_corner[1] -= q[1];
    return;
  }
  double along_xi[4], along_eta[4];
  shapeDerivatives(pair.weight, along_xi, along_eta);
  for (int j = 0; j < 4; ++j)
    forces.on_corner[j] -= q[0] * along_xi[j] + q[1] * along_eta[j];
}

} // namespace brickwall::contact
