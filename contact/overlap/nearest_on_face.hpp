// Distance of any point from a face including its rim; projection.hpp gives none where the point
// does not project onto the face.
#pragma once

#include "contact/surface/projection.hpp"

namespace brickwall::contact {

struct NearestOnFace {
  double square = HUGE_VAL; // of the distance
  // penetration, length; 0: in front of the face, or the nearest point is on the rim
  double depth = 0;
};

namespace projection {

// The point of the segment that is nearest to the origin.
KOKKOS_INLINE_FUNCTION Vec3 nearestOnSegment(const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double square = dot(along, along);
  const double t = square > 0 ? minOf(1.0, maxOf(0.0, -dot(a, along) / square)) : 0.0;
  return a + t * along;
}

// Nearest point on the four triangles about the centroid, which share the rim of the quad.
KOKKOS_INLINE_FUNCTION NearestOnFace nearestOnFourTriangles(const Quad& face, const Vec3& point) {
  NearestOnFace nearest;
  const Vec3 outward = areaVector(face);
  const auto take = [&](const Vec3& at, bool is_rim) {
    const double square = dot(at, at);
    if (!(square < nearest.square))
      return;
    nearest.square = square;
    nearest.depth = !is_rim && dot(outward, at) > 0 ? std::sqrt(square) : 0;
  };
  Vec3 q[4];
  for (int j = 0; j < 4; ++j)
    q[j] = face.corner[j] - point;
  const Vec3 centre = 0.25 * ((q[0] + q[1]) + (q[2] + q[3]));
  for (int j = 0; j < 4; ++j) {
    const Vec3 &here = q[j], &next = q[(j + 1) & 3];
    take(nearestOnSegment(here, next), true);
    take(nearestOnSegment(here, centre), false);
    double lambda[3];
    Vec3 normal;
    if (barycentric(here, next, centre, lambda, normal) && lambda[0] > 0 && lambda[1] > 0 &&
        lambda[2] > 0)
      take(dot(here, normal) * normal, false);
  }
  return nearest;
}

} // namespace projection

KOKKOS_INLINE_FUNCTION NearestOnFace nearestOnFace(const Quad& face, const Vec3& point) {
  constexpr double on_rim = 1e-9; // where two faces meet, in half-lengths
  const FacePoint foot = project(face, point);
  if (!foot.has_parameters || foot.excess > on_rim)
    return projection::nearestOnFourTriangles(face, point);
  return {foot.gap * foot.gap, foot.gap < 0 ? -foot.gap : 0};
}

} // namespace brickwall::contact
