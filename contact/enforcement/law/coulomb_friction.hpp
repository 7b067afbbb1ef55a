// Coulomb friction by return mapping: an elastic spring along the face holds until its force reaches mu F_n, then slips at
// that force. Point-wise.
#pragma once

#include "contact/enforcement/law/contact_history.hpp"

namespace brickwall::contact {

// The part of `a` that is perpendicular to the unit vector `normal`.
KOKKOS_INLINE_FUNCTION Vec3 tangentialPart(const Vec3& a, const Vec3& normal) {
  return a - dot(a, normal) * normal;
}

// A tangential force carried over to a face with another normal: its direction along that face, its magnitude kept, so that
// the energy in the spring stays as it turns with the body. Zero if nothing of it lies along the face.
KOKKOS_INLINE_FUNCTION Vec3 rotateToPlane(const Vec3& force, const Vec3& normal) {
  const Vec3 flat = tangentialPart(force, normal);
  const double square = dot(flat, flat);
  return square > 0 ? std::sqrt(dot(force, force) / square) * flat : Vec3();
}

// The trial force, or what is left of it when it exceeds the limit (>= 0).
KOKKOS_INLINE_FUNCTION Vec3 returnMap(const Vec3& trial, double limit) {
  const double size = norm(trial);
  return size > limit ? (limit / size) * trial : trial;
}

// Derivatives of a face's shape functions at the point of these weights. They are those of the bilinear quad, and sum to zero.
KOKKOS_INLINE_FUNCTION void shapeSlopes(const double (&weight)[4], double (&along_xi)[4],
                                        double (&along_eta)[4]) {
  const double bottom = 0.5 * (weight[0] + weight[1]), top = 0.5 * (weight[2] + weight[3]);
  const double left = 0.5 * (weight[0] + weight[3]), right = 0.5 * (weight[1] + weight[2]);
  along_xi[0] = -bottom, along_xi[1] = bottom, along_xi[2] = top, along_xi[3] = -top;
  along_eta[0] = -left, along_eta[1] = -right, along_eta[2] = right, along_eta[3] = left;
}

// P times the vectors dual to the tangents: a force t along both has the components lever . t/P. Zero where they are parallel.
KOKKOS_INLINE_FUNCTION void dualBasis(const Vec3& first, const Vec3& second, double P,
                                      Vec3 (&lever)[2]) {
  const double a = dot(first, first), b = dot(first, second), c = dot(second, second);
  const double determinant = a * c - b * b;
  if (!(determinant > 1e-4 * a * c))
    return;
  const double scale = P / determinant;
  lever[0] = scale * (c * first - b * second);
  lever[1] = scale * (a * second - b * first);
}

// The forces along the normal that balance the couple of the friction force (contact_history.hpp).
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
  shapeSlopes(pair.weight, along_xi, along_eta);
  for (int j = 0; j < 4; ++j)
    forces.on_corner[j] -= q[0] * along_xi[j] + q[1] * along_eta[j];
}

} // namespace brickwall::contact
