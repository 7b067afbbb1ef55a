// What keeps a node and a face apart that cannot touch (separation.hpp): the node stands before the face, or no face around it
// opposes that one.
#pragma once

#include "contact/enforcement/dormancy/separation.hpp"
#include "contact/enforcement/node_face/node_face_kinematics.hpp"

namespace brickwall::contact {

// Of a node, for all its candidates.
struct NodeSurroundings {
  TurnRate turn; // of the faces around it
  double flatness = 1; // |sum a n|/sum a over these faces: 1 amid a flat side, 0 for a needle's tip
  bool is_known = true; // false: some are other ranks', whose motion is not known here
};
KOKKOS_INLINE_FUNCTION NodeSurroundings surroundingsOf(const NodeFaceKinematics& touch,
                                                       const FaceAccess& faces, int node) {
  NodeSurroundings all;
  Vec3 outward;
  double area = 0;
  for (int k = touch.around.offsets(node); k < touch.around.offsets(node + 1); ++k) {
    const int row = touch.around.rows(k);
    if (row >= touch.num_faces) {
      all.is_known = false;
      return all;
    }
    all.turn.include(TurnRate::ofFace(faces.quad(row)));
    const double part = touch.around.corner_share(row) * touch.records(row).plane.area;
    outward += part * touch.records(row).plane.normal;
    area += part;
  }
  all.flatness = area > 0 ? norm(outward) / area : 0;
  return all;
}

// By how much the faces around a node may turn until its mean normal can oppose a face that none of them opposes. While none does,
// sum a n . n_F >= -c sum a with the cosine c of opposed faces, so the mean normal is not within the cosine C of sharp corners as
// long as the flatness is above c/C. When faces turn by t, their area vectors change by .45 t at most (separation.hpp).
KOKKOS_INLINE_FUNCTION double turnToSharp(double flatness, double opposed_cosine) {
  const double least = opposed_cosine / NodeFaceKinematics::sharp_cosine;
  return (flatness - least) / (0.45 * (1 + least));
}

// Why NodeFaceKinematics::test() fails at ContactTest::activate. Bodies that lie side by side have faces that are in one plane and turned the same
// way: no gap keeps these from touching, but their directions do, by far.
KOKKOS_INLINE_FUNCTION Separation separationOf(const NodeFaceKinematics& touch,
                                               const FaceAccess& faces,
                                               const NodeSurroundings& around, int node, int face) {
  constexpr double least_cosine = 0.1; // directions that are closer to opposing are left to the gap
  const MeanPlane& plane = touch.records(touch.recordOf(face)).plane;
  const Quad quad = faces.quad(face);
  const TurnRate turn = TurnRate::ofFace(quad);
  Separation apart;
  if (around.is_known) {
    double least = 2;
    for (int k = touch.around.offsets(node); k < touch.around.offsets(node + 1); ++k)
      least = minOf(least, dot(touch.records(touch.around.rows(k)).plane.normal, plane.normal) +
                               touch.opposed_cosine);
    least = minOf(least, turnToSharp(around.flatness, touch.opposed_cosine));
    if (least > least_cosine) {
      TurnRate both = turn;
      both.include(around.turn);
      apart.most_spread = both.mostSpread(least - 1e-9);
      return apart;
    }
  }
  // v = n . (x - c) - stretch |n . twist|/4 + depth > 0
  const Vec3 x = rowOf(faces.surface.coordinates_new, node);
  const double lateral = maxOf(touch.lateral_tolerance, FadeRegion::farthest);
  const double stretch = (1 + lateral) * (1 + lateral);
  const Vec3 sum = (quad.corner[0] + quad.corner[1]) + (quad.corner[2] + quad.corner[3]);
  const Vec3 twist = (quad.corner[0] - quad.corner[1]) + (quad.corner[2] - quad.corner[3]);
  apart.normal = plane.normal;
  apart.gap = dot(plane.normal, x) - plane.offset - (plane.warp * stretch - touch.least_depth);
  apart.arm = turn.rate * (norm(x - 0.25 * sum) + 0.25 * stretch * norm(twist)) + 0.5 * stretch;
  apart.arm_by_motion = turn.rate;
  apart.most_spread = turn.mostSpread(0.5);
  return apart;
}

} // namespace brickwall::contact
