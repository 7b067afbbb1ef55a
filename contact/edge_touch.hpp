// Contact of convex edges with convex edges that they cross: nodes and faces feel each other only when a node is inside, which
// for edges that cross in mid-cell is half a cell too late. Kernel functor parts for SelectInteractions.
//
// An "edge" is stored as a quad: corners 0 and 1 are its ends, and all four are the face of its body that lists it, so that
// its outward normals follow the body: n_1 is the face's, n_2 = cos n_1 + sin (t x n_1), t from corner 0 to corner 1.
#pragma once

#include "contact/select_interactions.hpp"

namespace brickwall::contact {

// 0 up to `low`, 1 from `high` on, smooth between.
KOKKOS_INLINE_FUNCTION double smoothStep(double value, double low, double high) {
  const double t = minOf(maxOf((value - low) / (high - low), 0.0), 1.0);
  return t * t * (3 - 2 * t);
}

// The directions that stick out of an edge: between the normals of its two faces.
struct EdgeCone {
  Vec3 tangent, first, second; // unit vectors: t, n_1, n_2

  KOKKOS_INLINE_FUNCTION EdgeCone(const Quad& quad, double cosine, double sine) {
    const Vec3 way = quad.corner[1] - quad.corner[0];
    tangent = (1 / norm(way)) * way;
    const Vec3 area = areaVector(quad);
    const Vec3 flat = area - dot(area, tangent) * tangent;
    first = (1 / norm(flat)) * flat;
    second = cosine * first + sine * cross(tangent, first);
  }
  // How far a unit vector across the edge lies inside the cone: the lesser sine of its angles to both normals (1 beyond a right
  // angle); negative outside.
  KOKKOS_INLINE_FUNCTION double depthOf(const Vec3& n) const {
    if (dot(n, first + second) <= 0)
      return -1;
    const double from_first = dot(cross(first, n), tangent);
    const double to_second = dot(cross(n, second), tangent);
    return minOf(dot(n, first) > 0 || from_first < 0 ? from_first : 1,
                 dot(n, second) > 0 || to_second < 0 ? to_second : 1);
  }
};

struct EdgeTouch {
  static constexpr bool has_fading = false;
  static constexpr bool books_spring_work = true;
  // Of face attributes, behind the corner masses: FeatureEdge's.
  static constexpr int cosine_column = 4, sine_column = 5, goes_on_column = 6, num_columns = 7;
  // Edges of smaller sines, between each other or to a face, are left to nodes and faces: a node half a cell away is then inside
  // before the depth is a twentieth of a cell. The force grows in from `least_sine` on.
  static constexpr double least_sine = 0.05, full_sine = 0.15;
  static constexpr double stiffness_share = 0.5; // of a node's: edges act beside nodes
  static constexpr double deepest =
      0.5; // of the shorter edge: what is deeper did not come through these edges

  double lateral_tolerance;
  int num_corners; // rows below it are ends of edges, row num_corners + e is edge e
  View<const double*> node_mass; // [corner]

  // Each pair of edges once: the one of the lower body pushes.
  KOKKOS_INLINE_FUNCTION bool pushes(global_id own_body, global_id body) const {
    return own_body <= body;
  }
  KOKKOS_INLINE_FUNCTION int edgeOf(int node) const { return node - num_corners; }

  KOKKOS_INLINE_FUNCTION bool test(const FaceAccess& faces, int node, int other, Hit& hit) const {
    const int own = edgeOf(node);
    const Quad a = faces.quad(own), b = faces.quad(other);
    const Vec3 da = a.corner[1] - a.corner[0], db = b.corner[1] - b.corner[0];
    const Vec3 between = a.corner[0] - b.corner[0];
    const double aa = dot(da, da), ab = dot(da, db), bb = dot(db, db);
    const double determinant = aa * bb - ab * ab; // |da x db|^2
    if (!(determinant > least_sine * least_sine * aa * bb))
      return false;
    const double ra = dot(da, between), rb = dot(db, between);
    const double s = (ab * rb - bb * ra) / determinant, t = (aa * rb - ab * ra) / determinant;
    if (!isOn(faces, own, s) || !isOn(faces, other, t))
      return false;
    const EdgeCone cone_b(b, faces.attribute(other, cosine_column),
                          faces.attribute(other, sine_column));
    const Vec3 across = cross(da, db);
    const double size = std::sqrt(dot(across, across));
    Vec3 normal = (1 / size) * across;
    if (dot(normal, cone_b.first + cone_b.second) < 0)
      normal = -normal;
    const double depth = -dot(between, normal);
    if (!(depth > 0 && depth * depth < deepest * deepest * minOf(aa, bb)))
      return false;
    const EdgeCone cone_a(a, faces.attribute(own, cosine_column),
                          faces.attribute(own, sine_column));
    const double inside = minOf(cone_a.depthOf(-normal), cone_b.depthOf(normal));
    const double taper = smoothStep(inside, least_sine, full_sine) *
                         smoothStep(size / std::sqrt(aa * bb), least_sine, full_sine);
    if (!(taper > 0) || sharesNode(faces, own, other))
      return false;
    hit.weight[0] = 1 - t, hit.weight[1] = t;
    hit.weight[2] = hit.weight[3] = 0;
    for (int d = 0; d < 3; ++d)
      hit.normal[d] = normal[d];
    hit.place[0] = s;
    hit.place[1] = taper;
    hit.depth = depth;
    hit.face = other;
    return true;
  }

  // Whether a point at share `s` of the edge's length is on it: exactly where another edge goes on, else with a tolerance.
  KOKKOS_INLINE_FUNCTION bool isOn(const FaceAccess& faces, int edge, double s) const {
    const int goes_on = static_cast<int>(faces.attribute(edge, goes_on_column));
    const double beyond = 0.5 * lateral_tolerance;
    return s >= (goes_on & 1 ? 0 : -beyond) && (goes_on & 2 ? s < 1 : s <= 1 + beyond);
  }

  // A contact that slid here along its brick's edge from the edge before or behind it, not too deep: it goes on with what it
  // stored there, as if its offset had been zero.
  KOKKOS_INLINE_FUNCTION bool slidHere(const FaceAccess& faces, int node, const Hit& hit) const {
    const int own = edgeOf(node);
    const int goes_on = static_cast<int>(faces.attribute(own, goes_on_column));
    const Vec3 a0 =
        faces.corner(own, 0, faces.surface.coordinates_old, faces.ghosts.coordinates_old);
    const Vec3 a1 =
        faces.corner(own, 1, faces.surface.coordinates_old, faces.ghosts.coordinates_old);
    const Vec3 b0 =
        faces.corner(hit.face, 0, faces.surface.coordinates_old, faces.ghosts.coordinates_old);
    const Vec3 b1 =
        faces.corner(hit.face, 1, faces.surface.coordinates_old, faces.ghosts.coordinates_old);
    const Vec3 da = a1 - a0, db = b1 - b0, between = a0 - b0;
    const double aa = dot(da, da), ab = dot(da, db), bb = dot(db, db);
    const double determinant = aa * bb - ab * ab;
    const double s = (ab * dot(db, between) - bb * dot(da, between)) / determinant;
    const bool was_inside = dot(between, hit.unitNormal()) < 0;
    constexpr double shallow = 0.1;
    return was_inside && ((s < 0 && goes_on & 1) || (s >= 1 && goes_on & 2)) &&
           hit.depth * hit.depth < shallow * shallow * minOf(aa, bb);
  }

  // Neighbours on one body never push each other, and of two edges of one body only one pushes.
  KOKKOS_INLINE_FUNCTION static bool sharesNode(const FaceAccess& faces, int own, int other) {
    if (faces.body(own) != faces.body(other))
      return false;
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        if (faces.cornerId(own, i) == faces.cornerId(other, j))
          return true;
    return faces.id(own) >= faces.id(other);
  }

  KOKKOS_INLINE_FUNCTION ContactPoint pointOf(const FaceAccess& faces, int node,
                                              const Hit& hit) const {
    ContactPoint point;
    point.node[0] = faces.surface.face_to_nodes(edgeOf(node), 0);
    point.node[1] = faces.surface.face_to_nodes(edgeOf(node), 1);
    point.share = hit.place[0];
    return point;
  }
  KOKKOS_INLINE_FUNCTION double inverseMass(const ContactPoint& point) const {
    return (1 - point.share) * (1 - point.share) / node_mass(point.node[0]) +
           point.share * point.share / node_mass(point.node[1]);
  }
  KOKKOS_INLINE_FUNCTION double relativeDepth(const FaceAccess& faces, const Hit& hit) const {
    const Quad quad = faces.quad(hit.face);
    return hit.depth / norm(quad.corner[1] - quad.corner[0]);
  }
  KOKKOS_INLINE_FUNCTION void record(int, int, double) const {}

  KOKKOS_INLINE_FUNCTION double stiffnessCap(const EnforcementConfig& config, const FaceAccess&,
                                             int, const Hit (&)[max_interactions], int, int,
                                             double inverse_mass) const {
    return stiffness_share * config.penalty /
           (config.reference_step * config.reference_step * inverse_mass);
  }
  KOKKOS_INLINE_FUNCTION double taper(const FaceAccess&, const Interaction&, const Hit& hit,
                                      const ContactHistory&, FadingForce&) const {
    return hit.place[1];
  }
};

} // namespace brickwall::contact
