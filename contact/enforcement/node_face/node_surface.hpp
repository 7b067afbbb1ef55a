// The faces around a surface node: whether they oppose a direction, eq. (8) of theory.md, and their
// tributary area with respect to it, eq. (11).
#pragma once

#include "contact/enforcement/node_face/node_faces.hpp"

namespace brickwall::contact {

struct NodeSurface {
  // A node whose faces are all steep with respect to a face sticks out towards it if its mean
  // normal is within 44.8 degrees. If the angle is larger, a face of the sharpest corner (three
  // faces 120 degrees apart) opposes: sin 44.8 cos 60 > opposed_cosine.
  static constexpr double sharp_cosine = 0.71;

  NodeFaceLists adjacent_faces;
  View<const FaceRecord*> records; // own, remote, ghost faces
  double opposed_cosine;

  // Tributary area of a node with respect to a direction, A_i, and its mean surface mass; both zero
  // if no face opposes.
  struct Tributary {
    double area = 0; // length^2
    double surface_mass = 0; // mass/area
  };

  // A face of the node opposes the direction, or the node sticks out towards it with all its faces
  // steep.
  KOKKOS_INLINE_FUNCTION bool isOpposed(int node, const Vec3& normal, double cosine) const {
    const int begin = adjacent_faces.offsets(node), end = adjacent_faces.offsets(node + 1);
    for (int k = begin; k < end; ++k)
      if (opposes(records(adjacent_faces.rows(k)).plane, normal, cosine))
        return true;
    Vec3 outward;
    for (int k = begin; k < end; ++k) {
      const int row = adjacent_faces.rows(k);
      const MeanPlane& plane = records(row).plane;
      outward += (adjacent_faces.corner_share(row) * plane.area) * plane.normal;
    }
    const double along = dot(outward, normal);
    return along < 0 && along * along > sharp_cosine * sharp_cosine * dot(outward, outward);
  }
  // Whether the body lies beyond the node in a direction: it opposes the direction, and no face is
  // as much along it. At an acute corner a face opposes the direction that the other face looks to.
  KOKKOS_INLINE_FUNCTION bool liesBeyond(int node, const Vec3& direction) const {
    if (!isOpposed(node, direction, opposed_cosine))
      return false;
    double least = 0, largest = 0;
    for (int k = adjacent_faces.offsets(node); k < adjacent_faces.offsets(node + 1); ++k) {
      const double along = dot(records(adjacent_faces.rows(k)).plane.normal, direction);
      least = minOf(least, along);
      largest = maxOf(largest, along);
    }
    return largest < -least;
  }
  KOKKOS_INLINE_FUNCTION Tributary tributary(int node, const Vec3& normal) const {
    const Tributary part = tributary(node, normal, opposed_cosine);
    return part.area > 0 ? part : tributary(node, normal, 0);
  }
  // Sums over the faces that oppose the direction.
  KOKKOS_INLINE_FUNCTION Tributary tributary(int node, const Vec3& normal, double cosine) const {
    Tributary part;
    for (int k = adjacent_faces.offsets(node); k < adjacent_faces.offsets(node + 1); ++k) {
      const int row = adjacent_faces.rows(k);
      const MeanPlane& plane = records(row).plane;
      if (!opposes(plane, normal, cosine))
        continue;
      const double area = adjacent_faces.corner_share(row) * plane.area;
      part.area += area;
      part.surface_mass += adjacent_faces.surface_mass(row) * area;
    }
    if (part.area > 0)
      part.surface_mass /= part.area;
    return part;
  }

private:
  KOKKOS_INLINE_FUNCTION static bool opposes(const MeanPlane& plane, const Vec3& normal,
                                             double cosine) {
    return dot(plane.normal, normal) < -cosine;
  }
};

} // namespace brickwall::contact
