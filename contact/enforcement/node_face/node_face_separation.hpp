// Separation bound of a node and a face (separation.hpp): the node is in front of the face, or no
// face around the node opposes it.
#pragma once

#include "contact/enforcement/dormancy/separation.hpp"
#include "contact/enforcement/node_face/node_face_kinematics.hpp"

namespace brickwall::contact {

// Properties of a node for the bounds with all its candidates.
struct NodeSurroundings {
  TurnRate turn; // of the faces around it
  // |sum a n|/sum a over these faces: 1 within a flat side, 0 at the tip of a needle
  double flatness = 1;
  bool is_known = true; // false: some faces belong to other ranks, whose motion is unknown here
};
KOKKOS_INLINE_FUNCTION NodeSurroundings surroundingsOf(const NodeFaceKinematics& kinematics,
                                                       const FaceAccess& faces, int node) {
  NodeSurroundings all;
  Vec3 outward;
  double area = 0;
  for (int k = kinematics.adjacent_faces.offsets(node);
       k < kinematics.adjacent_faces.offsets(node + 1); ++k) {
    const int row = kinematics.adjacent_faces.rows(k);
    if (row >= kinematics.num_faces) {
      all.is_known = false;
      return all;
    }
    all.turn.include(TurnRate::ofFace(faces.quad(row)));
    const double part =
        kinematics.adjacent_faces.corner_share(row) * kinematics.records(row).plane.area;
    outward += part * kinematics.records(row).plane.normal;
    area += part;
  }
  all.flatness = area > 0 ? norm(outward) / area : 0;
  return all;
}

// Rotation of the faces around a node after which its mean normal can oppose a face that none of
// them opposes. While none does, sum a n . n_F >= -c sum a with the cosine c of opposed faces, so
// the mean normal is not within the cosine C of sharp corners as long as the flatness is above c/C.
// When faces turn by t, their area vectors change by 0.45 t at most (separation.hpp).
KOKKOS_INLINE_FUNCTION double turnToSharp(double flatness, double opposed_cosine) {
  const double least = opposed_cosine / NodeFaceKinematics::sharp_cosine;
  return (flatness - least) / (0.45 * (1 + least));
}

// The bound under which NodeFaceKinematics::test() fails at ContactTest::activate. Bodies side by
// side have faces in one plane with equal normals: no gap separates these, but their directions do.
KOKKOS_INLINE_FUNCTION Separation separationOf(const NodeFaceKinematics& kinematics,
                                               const FaceAccess& faces,
                                               const NodeSurroundings& around, int node, int face) {
  constexpr double least_cosine = 0.1; // directions closer to opposing are left to the gap
  const MeanPlane& plane = kinematics.records(kinematics.recordOf(face)).plane;
  const Quad quad = faces.quad(face);
  const TurnRate turn = TurnRate::ofFace(quad);
  Separation separation;
  if (around.is_known) {
    double least = 2;
    for (int k = kinematics.adjacent_faces.offsets(node);
         k < kinematics.adjacent_faces.offsets(node + 1); ++k)
      least = minOf(least, dot(kinematics.records(kinematics.adjacent_faces.rows(k)).plane.normal,
                               plane.normal) +
                               kinematics.opposed_cosine);
    least = minOf(least, turnToSharp(around.flatness, kinematics.opposed_cosine));
    if (least > least_cosine) {
      TurnRate both = turn;
      both.include(around.turn);
      separation.max_spread = both.maxSpread(least - 1e-9);
      return separation;
    }
  }
  // gap of MeanPlane::surelyOutside(): n . (x - c) - stretch |n . twist|/4 + depth > 0
  const Vec3 x = rowOf(faces.surface.coordinates_new, node);
  const double stretch = (1 + kinematics.lateral_tolerance) * (1 + kinematics.lateral_tolerance);
  const Vec3 sum = (quad.corner[0] + quad.corner[1]) + (quad.corner[2] + quad.corner[3]);
  const Vec3 twist = (quad.corner[0] - quad.corner[1]) + (quad.corner[2] - quad.corner[3]);
  separation.normal = plane.normal;
  separation.gap =
      dot(plane.normal, x) - plane.offset - (plane.warp * stretch - kinematics.least_depth);
  separation.arm =
      turn.rate * (norm(x - 0.25 * sum) + 0.25 * stretch * norm(twist)) + 0.5 * stretch;
  separation.arm_by_motion = turn.rate;
  separation.max_spread = turn.maxSpread(0.5);
  return separation;
}

} // namespace brickwall::contact
