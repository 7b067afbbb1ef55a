// Uniform access to candidate faces, own ones and ghosts: both give the same bits.
#pragma once

#include "contact/surface/construct_boxes.hpp"
#include "contact/surface/contact_point.hpp"
#include "contact/surface/projection.hpp"
#include "contact/surface/surface.hpp"

namespace brickwall::contact {

// Faces by candidate index: own faces below num_faces, then ghosts (CandidatePairs). For kernels.
struct FaceAccess {
  SweptBoxes surface;
  GhostFaces ghosts;

  KOKKOS_INLINE_FUNCTION bool isOwn(int face) const { return face < surface.num_faces; }
  KOKKOS_INLINE_FUNCTION int ghostOf(int face) const { return face - surface.num_faces; }

  KOKKOS_INLINE_FUNCTION global_id id(int face) const {
    return isOwn(face) ? surface.face_ids(face) : ghosts.face_ids(ghostOf(face));
  }
  KOKKOS_INLINE_FUNCTION global_id body(int face) const { return bodyOfSide(side(face)); }
  KOKKOS_INLINE_FUNCTION global_id side(int face) const {
    return isOwn(face) ? surface.face_body(face) : ghosts.bodies(ghostOf(face));
  }
  KOKKOS_INLINE_FUNCTION global_id cornerId(int face, int j) const {
    return isOwn(face) ? surface.node_ids(surface.face_to_nodes(face, j))
                       : ghosts.corner_ids(ghostOf(face), j);
  }
  // The attributes of a face, which are of type T.
  template <class T = FaceAttributes>
  KOKKOS_FORCEINLINE_FUNCTION const T& attributes(int face) const {
    return isOwn(face) ? attributesAt<T>(surface.face_attributes, face)
                       : attributesAt<const T>(ghosts.attributes, ghostOf(face));
  }
  KOKKOS_INLINE_FUNCTION double cornerMass(int face, int j) const {
    return attributes<CornerMasses>(face).corner_mass[j];
  }
  // A value at corner j: of own faces from `of_nodes` [node][3], of ghosts from `of_ghosts`
  // [ghost][3 * corner + xyz].
  template <class NodeView, class GhostView>
  KOKKOS_INLINE_FUNCTION Vec3 corner(int face, int j, const NodeView& of_nodes,
                                     const GhostView& of_ghosts) const {
    if (isOwn(face))
      return rowOf(of_nodes, surface.face_to_nodes(face, j));
    const int ghost = ghostOf(face);
    return {of_ghosts(ghost, 3 * j), of_ghosts(ghost, 3 * j + 1), of_ghosts(ghost, 3 * j + 2)};
  }
  template <class NodeView, class GhostView>
  KOKKOS_FORCEINLINE_FUNCTION void corners(int face, const NodeView& of_nodes,
                                           const GhostView& of_ghosts, Vec3 (&values)[4]) const {
    if (isOwn(face))
      for (int j = 0; j < 4; ++j)
        values[j] = rowOf(of_nodes, surface.face_to_nodes(face, j));
    else
      for (int j = 0; j < 4; ++j)
        values[j] = corner(face, j, of_nodes, of_ghosts);
  }
  // At x^{n+1}.
  KOKKOS_INLINE_FUNCTION Quad quad(int face) const {
    Quad q;
    for (int j = 0; j < 4; ++j)
      q.corner[j] = corner(face, j, surface.coordinates_new, ghosts.coordinates_new);
    return q;
  }
  // The same at x^n.
  KOKKOS_INLINE_FUNCTION Quad oldQuad(int face) const {
    Quad q;
    for (int j = 0; j < 4; ++j)
      q.corner[j] = corner(face, j, surface.coordinates_old, ghosts.coordinates_old);
    return q;
  }
  // Prefetches the corner numbers of a face; prefetchCorners() then prefetches values of its
  // corners.
  KOKKOS_FORCEINLINE_FUNCTION void prefetchNumbers(int face) const {
    if (isOwn(face))
      prefetch(&surface.face_to_nodes(face, 0));
  }
  // The same, and the attributes of the face.
  KOKKOS_FORCEINLINE_FUNCTION void prefetchFace(int face) const {
    if (!isOwn(face))
      return;
    prefetchNumbers(face);
    prefetch(&surface.face_attributes(face, 0));
    prefetch(&surface.face_attributes(face, surface.face_attributes.extent(1) - 1));
  }
  template <class NodeView>
  KOKKOS_FORCEINLINE_FUNCTION void prefetchCorners(int face, const NodeView& of_nodes) const {
    if (isOwn(face))
      for (int j = 0; j < 4; ++j)
        prefetchRow(of_nodes, surface.face_to_nodes(face, j));
  }
  // Whether the swept boxes of node and face overlap at these tolerances, decided with the same
  // bits as in the searches.
  KOKKOS_INLINE_FUNCTION bool boxesOverlap(int node, int face, double node_tolerance,
                                           double face_tolerance) const {
    const Box box = isOwn(face) ? faceBox(surface.coordinates_old, surface.coordinates_new,
                                          surface.face_to_nodes, face, face_tolerance)
                                : ghostBox(ghosts.coordinates_old, ghosts.coordinates_new,
                                           ghostOf(face), face_tolerance);
    return box.overlaps(nodeBox(rowOf(surface.coordinates_old, node),
                                rowOf(surface.coordinates_new, node), node_tolerance));
  }
  // Whether a search in this step would list the pair; lists with a margin contain more.
  KOKKOS_INLINE_FUNCTION bool isOfThisStep(const StepTest& test, int node, int face) const {
    return !test.is_needed || boxesOverlap(node, face, test.node_tolerance, test.face_tolerance);
  }
  // x^{n+1} - x^n of a corner, length.
  KOKKOS_INLINE_FUNCTION Vec3 cornerMotion(int face, int j) const {
    return corner(face, j, surface.coordinates_new, ghosts.coordinates_new) -
           corner(face, j, surface.coordinates_old, ghosts.coordinates_old);
  }
  KOKKOS_INLINE_FUNCTION Vec3 nodeMotion(int node) const {
    return rowOf(surface.coordinates_new, node) - rowOf(surface.coordinates_old, node);
  }
  KOKKOS_INLINE_FUNCTION Vec3 motionOf(const ContactPoint& point) const {
    const Vec3 motion = nodeMotion(point.node[0]);
    return point.isNode() ? motion
                          : (1 - point.share) * motion + point.share * nodeMotion(point.node[1]);
  }
  // Motion of a point in this step as seen from the face point with these weights: length.
  KOKKOS_INLINE_FUNCTION Vec3 relativeMotion(const ContactPoint& point, int face,
                                             const double (&weight)[4]) const {
    Vec3 motion = motionOf(point);
    for (int j = 0; j < 4; ++j)
      motion -= weight[j] * cornerMotion(face, j);
    return motion;
  }
};

} // namespace brickwall::contact
