// Geometry of convex edges: the cone of outward directions of an edge, and the closest points of
// two edges' lines; eqs. (29) and (30) of theory.md. Point-wise.
//
// An edge is stored as a quad: corners 0 and 1 are its ends, and all four are the face of its body
// that lists it, so that its outward normals follow the body: n_1 is the face's, n_2 = cos n_1 +
// sin (t x n_1), t from corner 0 to corner 1.
#pragma once

#include "contact/enforcement/edge_edge/edge_surface.hpp"
#include "contact/surface/face_access.hpp"

namespace brickwall::contact {

// The outward directions of an edge: those between the normals of its two faces.
struct EdgeCone {
  Vec3 tangent, first, second; // unit vectors: t, n_1, n_2

  KOKKOS_INLINE_FUNCTION EdgeCone(const Quad& quad, const EdgeAttributes& edge) {
    const Vec3 way = quad.corner[1] - quad.corner[0];
    tangent = (1 / norm(way)) * way;
    const Vec3 area = areaVector(quad);
    const Vec3 flat = area - dot(area, tangent) * tangent;
    first = (1 / norm(flat)) * flat;
    second = edge.cosine * first + edge.sine * cross(tangent, first);
  }
  // How far a unit vector perpendicular to the edge lies inside the cone: the smaller sine of its
  // angles to both normals (1 beyond a right angle); negative outside.
  KOKKOS_INLINE_FUNCTION double depthOf(const Vec3& n) const {
    if (dot(n, first + second) <= 0) // leads into the body
      return -1;
    const double from_first = dot(cross(first, n), tangent);
    const double to_second = dot(cross(n, second), tangent);
    return minOf(dot(n, first) > 0 || from_first < 0 ? from_first : 1,
                 dot(n, second) > 0 || to_second < 0 ? to_second : 1);
  }
};

// Closest points of the lines a + s da and b + t db, with between = a - b; eq. (29).
struct Crossing {
  double aa, bb, determinant; // |da|^2, |db|^2, |da x db|^2
  double s, t;

  KOKKOS_INLINE_FUNCTION Crossing(const Vec3& da, const Vec3& db, const Vec3& between) {
    aa = dot(da, da), bb = dot(db, db);
    const double ab = dot(da, db), ra = dot(da, between), rb = dot(db, between);
    determinant = aa * bb - ab * ab;
    s = (ab * rb - bb * ra) / determinant, t = (aa * rb - ab * ra) / determinant;
  }
  KOKKOS_INLINE_FUNCTION bool isAcross(double sine) const {
    return determinant > sine * sine * aa * bb;
  }
  KOKKOS_INLINE_FUNCTION bool isFarBeyond(double reach) const {
    return maxOf(maxOf(-s, s - 1), maxOf(-t, t - 1)) > reach;
  }
};

// A side of a body next to one of its edges.
struct EdgeSide {
  Vec3 inward, tangent; // unit vectors in the side: from the edge, and along it
  double width, length; // of the side, and of the edge
  int continued_ends; // FeatureEdge::goes_on

  // Whether another edge, which crosses this one at the weights `at` and `at_other`, ends beyond it
  // and, on the other end, beyond the width or beyond a free end of this edge, where it cuts off a
  // corner of the side. `overhang` in widths and lengths.
  KOKKOS_INLINE_FUNCTION bool isSpannedBy(const Vec3& other_edge, double at, double at_other,
                                          double overhang) const {
    const double across = dot(other_edge, inward);
    const double to_inner_end = across > 0 ? 1 - at_other : -at_other;
    const double to_outer_end = across > 0 ? -at_other : 1 - at_other;
    if (!(to_outer_end * across < -overhang * width))
      return false;
    const double inner_end = at + to_inner_end * dot(other_edge, tangent) / length;
    return to_inner_end * across > (1 + overhang) * width ||
           (inner_end < -overhang && !(continued_ends & 1)) ||
           (inner_end > 1 + overhang && !(continued_ends & 2));
  }
};

// An edge of a pair of edges that cross.
struct CrossedEdge {
  Vec3 way; // from its first end to its second
  EdgeCone cone;
  double at; // weight of the crossing
  const EdgeAttributes& attributes;

  KOKKOS_INLINE_FUNCTION CrossedEdge(const FaceAccess& faces, int edge, const Quad& quad,
                                     double weight)
      : way(quad.corner[1] - quad.corner[0]), cone(quad, faces.attributes<EdgeAttributes>(edge)),
        at(weight), attributes(faces.attributes<EdgeAttributes>(edge)) {}

  // The side out of which a direction on the rim of the cone leads.
  KOKKOS_INLINE_FUNCTION EdgeSide sideAlong(const Vec3& n) const {
    const bool is_first = dot(n, cone.first) > dot(n, cone.second);
    return {is_first ? cross(cone.first, cone.tangent) : cross(cone.tangent, cone.second),
            cone.tangent, attributes.width[is_first ? 0 : 1], norm(way),
            static_cast<int>(attributes.goes_on)};
  }
};

// Edges face each other if their common normal leads out of one and, reversed, out of the other:
// it lies inside the cone of an edge, or on its rim where the other edge spans a side.
struct EdgesFacing {
  double least_sine; // to the rim
  double overhang; // see EdgeSide::isSpannedBy()

  // `normal` leads from b to a.
  KOKKOS_INLINE_FUNCTION bool holds(const CrossedEdge& a, const CrossedEdge& b,
                                    const Vec3& normal) const {
    return leadsOut(-normal, a, b) && leadsOut(normal, b, a);
  }
  // Whether the edges had crossed at x^n already, with the normal on the same side, and faced each
  // other. A contact becomes active when edges come to cross or, after other edges have held the
  // bodies, come to face each other, not when edges that have crossed come to lie side by side.
  KOKKOS_INLINE_FUNCTION bool hadMet(const FaceAccess& faces, int own, int other,
                                     const Vec3& normal) const {
    const Quad quad_a = faces.oldQuad(own), quad_b = faces.oldQuad(other);
    const Vec3 da = quad_a.corner[1] - quad_a.corner[0], db = quad_b.corner[1] - quad_b.corner[0];
    const Vec3 between = quad_a.corner[0] - quad_b.corner[0], across = cross(da, db);
    const Vec3 old_normal = ((dot(across, normal) < 0 ? -1 : 1) / norm(across)) * across;
    const Crossing crossing(da, db, between);
    return dot(between, old_normal) < 0 &&
           holds({faces, own, quad_a, crossing.s}, {faces, other, quad_b, crossing.t}, old_normal);
  }

private:
  KOKKOS_INLINE_FUNCTION bool leadsOut(const Vec3& n, const CrossedEdge& of,
                                       const CrossedEdge& other) const {
    const double inside = of.cone.depthOf(n);
    return inside > least_sine ||
           (inside > -least_sine &&
            of.sideAlong(n).isSpannedBy(other.way, of.at, other.at, overhang));
  }
};

// Whether the two edges belong to one body and share a node, or `own` is the second of the pair.
// Such a pair is never in contact.
KOKKOS_INLINE_FUNCTION bool sharesNode(const FaceAccess& faces, int own, int other) {
  if (faces.body(own) != faces.body(other))
    return false;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      if (faces.cornerId(own, i) == faces.cornerId(other, j))
        return true;
  return faces.id(own) >= faces.id(other);
}

} // namespace brickwall::contact
