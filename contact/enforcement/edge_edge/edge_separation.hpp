// Separation bound of two edges (separation.hpp): they are nearly parallel, their common normal
// does not lead out of their bodies, or there is a gap along it.
#pragma once

#include "contact/enforcement/dormancy/separation.hpp"
#include "contact/enforcement/edge_edge/edge_edge_kinematics.hpp"

namespace brickwall::contact {

// An edge with its cone, and the rates at which they rotate.
struct TurningEdge {
  Quad quad;
  EdgeCone cone;
  Vec3 vector; // from its first end to its second
  double turn; // of its direction
  double cone_turn; // largest, of the cone's normals
  double limit; // of s

  KOKKOS_INLINE_FUNCTION TurningEdge(const FaceAccess& faces, int edge)
      : quad(faces.quad(edge)), cone(quad, faces.attributes<EdgeAttributes>(edge)) {
    vector = quad.corner[1] - quad.corner[0];
    const double length = norm(vector);
    turn = 2 / length;
    // n_1 = f/|f|, f = a - (a . t) t; n_2 = cos n_1 + sin t x n_1
    const Vec3 area = areaVector(quad), tangent = (1 / length) * vector;
    const TurnRate of_area = TurnRate::ofFace(quad);
    // |da| per s
    const double by_area = 0.5 * of_area.rate * norm(area);
    const double flat = norm(area - dot(area, tangent) * tangent);
    cone_turn = 2 * (2 * (by_area + 2 * norm(area) * turn) / flat) + turn;
    limit = of_area.limit;
  }
  // How far a unit vector perpendicular to the edge surely lies outside the cone, as
  // EdgeCone::depthOf() computes it; otherwise negative.
  KOKKOS_INLINE_FUNCTION double outside(const Vec3& n) const {
    return maxOf(
        -dot(n, cone.first + cone.second),
        maxOf(-dot(cross(cone.first, n), cone.tangent), -dot(cross(n, cone.second), cone.tangent)));
  }
};

KOKKOS_INLINE_FUNCTION TurningEdge surroundingsOf(const EdgeEdgeKinematics& kinematics,
                                                  const FaceAccess& faces, int node) {
  return TurningEdge(faces, kinematics.edgeOf(node));
}

// The bound under which EdgeEdgeKinematics::test() fails at ContactTest::activate.
KOKKOS_INLINE_FUNCTION Separation separationOf(const EdgeEdgeKinematics&, const FaceAccess& faces,
                                               const TurningEdge& own, int, int other_edge) {
  constexpr double least_outside = 0.1; // directions closer to a cone are left to the gap
  const TurningEdge other(faces, other_edge);
  const Crossing crossing(own.vector, other.vector, own.quad.corner[0] - other.quad.corner[0]);
  const double sine = std::sqrt(maxOf(crossing.determinant, 0.0) / (crossing.aa * crossing.bb));
  Separation separation;
  // The determinant of parallel edges is a rounding error.
  const double room = EdgeEdgeKinematics::least_sine - 1e-6 - sine;
  if (room > 0) {
    separation.max_spread = room / maxOf(own.turn, other.turn);
    return separation;
  }
  if (!(sine > 1.5 * EdgeEdgeKinematics::least_sine))
    return separation;
  const Vec3 across = cross(own.vector, other.vector);
  Vec3 normal = (1 / norm(across)) * across;
  const double normal_turn = 2 * (own.turn + other.turn) / sine;
  double outward = dot(normal, other.cone.first + other.cone.second);
  if (outward < 0) {
    normal = -normal;
    outward = -outward;
  }
  // Rates of the products in depthOf() and of `outward`.
  const double rate =
      2 * normal_turn + 2 * maxOf(own.cone_turn, other.cone_turn) + 2 * maxOf(own.turn, other.turn);
  const double limit = minOf(own.limit, other.limit);
  // The sign of `outward` must not change, and the edges must not become parallel.
  const double max_change = minOf(minOf(outward, 0.5) - 1e-9, 0.5 * sine);
  if (!(max_change > 0 && rate > 0))
    return separation;
  const double outside = maxOf(own.outside(-normal), other.outside(normal));
  if (outside > least_outside) {
    // on the rim they may become active
    const double room_outside = outside - EdgeEdgeKinematics::least_sine - 1e-9;
    separation.max_spread = minOf(limit, minOf(max_change, room_outside) / rate);
    return separation;
  }
  const Vec3 between = own.quad.corner[0] - other.quad.corner[0];
  separation.normal = normal;
  separation.gap = dot(between, normal);
  separation.arm = normal_turn * norm(between);
  separation.arm_by_motion = normal_turn;
  separation.max_spread = minOf(limit, max_change / rate);
  return separation;
}

} // namespace brickwall::contact
