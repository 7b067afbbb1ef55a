// Contacts of nodes with faces that lie flush against the planes of the nodes' faces, for
// findJointAreas().
#pragma once

#include "contact/enforcement/node_face/node_face_kinematics.hpp"

#include <cmath>

namespace brickwall::contact {

// A node and a face are flush if their planes are parallel by this cosine, and if the gap or
// penetration is within this share of the face's size.
inline constexpr double flush_cosine = 0.999, flush_gap = 1e-4;
// At a bend by this cosine at most a surface is curved, and its nodes have no plane that is flush
// with a face; at a sharper one it ends.
inline constexpr double bend_cosine = 0.9;

// The flush contacts of nodes, one with each opposing side.
struct FlushContacts {
  NodeFaceKinematics kinematics;
  FaceAccess faces;
  CandidatePairs pairs;
  View<unsigned char*> is_chosen; // [pair] 0 at first

  // Chooses among the candidates of a row the face of each side that covers the node best.
  KOKKOS_INLINE_FUNCTION void choose(std::int64_t row) const {
    const int node = pairs.node(row);
    const global_id own_body = faces.surface.node_body(node);
    const std::int64_t end = pairs.end(row);
    for (std::int64_t p = pairs.begin(row); p < end;) {
      const global_id side = kinematics.sideOf(faces, pairs.faces(p));
      std::int64_t best = -1;
      double least_excess = HUGE_VAL;
      for (; p < end && kinematics.sideOf(faces, pairs.faces(p)) == side; ++p)
        if (bodyOfSide(side) != own_body && isBetter(node, pairs.faces(p), least_excess))
          best = p;
      if (best >= 0)
        is_chosen(best) = 1;
    }
  }
  // Whether the face is flush with the node and exceeds it less, which is stored.
  KOKKOS_INLINE_FUNCTION bool isBetter(int node, int face, double& least_excess) const {
    const MeanPlane& plane = kinematics.recordOfFace(face).plane;
    const double area = kinematics.tributary(node, plane.normal, flush_cosine).area;
    if (!(area > 0) || area != kinematics.tributary(node, plane.normal, bend_cosine).area ||
        !faces.isOfThisStep(pairs.step_test, node, face))
      return false;
    const FacePoint point = projected(node, face);
    if (!point.activeWithin(kinematics.lateral_tolerance) || !(point.excess < least_excess) ||
        !(std::fabs(point.gap) <= flush_gap * std::sqrt(plane.area)))
      return false;
    FaceContact found;
    found.place[0] = point.xi;
    found.place[1] = point.eta;
    if (kinematics.overlapsOnlyAtEdge(faces, node, face, found))
      return false;
    least_excess = point.excess;
    return true;
  }
  KOKKOS_INLINE_FUNCTION FacePoint projected(int node, int face) const {
    return project(faces.quad(face), rowOf(faces.surface.coordinates_new, node));
  }
  // The number of chosen faces of a row.
  KOKKOS_INLINE_FUNCTION std::int64_t operator()(std::int64_t row) const {
    std::int64_t count = 0;
    for (std::int64_t p = pairs.begin(row); p < pairs.end(row); ++p)
      count += is_chosen(p);
    return count;
  }
  // The contact with a chosen face; its `force` is the tributary area.
  KOKKOS_INLINE_FUNCTION Interaction contact(int node, int face) const {
    const FacePoint point = projected(node, face);
    Interaction contact;
    contact.side = kinematics.sideOf(faces, face);
    contact.face_index = face;
    contact.node = node;
    contact.point = atNode(node);
    contact.normal = point.normal;
    for (int j = 0; j < 4; ++j)
      contact.weight[j] = point.weight[j];
    contact.force =
        kinematics.tributary(node, kinematics.recordOfFace(face).plane.normal, flush_cosine).area;
    return contact;
  }
};

} // namespace brickwall::contact
