// Contact of surface nodes with faces: closest point, the opposed-normal rule, and the stiffness of a node's area.
#pragma once

#include "contact/enforcement/law/edge_fading.hpp"
#include "contact/enforcement/law/persistent_contact.hpp"
#include "contact/enforcement/node_face/node_faces.hpp"
#include "contact/enforcement/selection/select_interactions.hpp"

namespace brickwall::contact {

struct NodeFaceKinematics {
  static constexpr bool books_spring_work =
      false; // it is the ledger's contact work, less that of edges, friction, damping

  static constexpr bool knows_motion = true; // look() works out all of a PersistentContact
  static constexpr bool tests_rows_together = false;

  // In half-lengths of a face: bodies whose edges overlap by less pass each other.
  static constexpr double edge_overlap_tolerance = 0.02;

  // A node whose faces are all steep against a face sticks out against it if its mean normal is within 44.8 degrees. Where it is
  // farther off, a face of the slimmest corner, its three faces 120 degrees apart, opposes: sin 44.8 cos 60 > opposed_cosine.
  static constexpr double sharp_cosine = 0.71;

  double lateral_tolerance, edge_tolerance, opposed_cosine, shared_cosine, least_depth;
  NodeFaceLists around;
  View<const FaceRecord*> records; // own, remote, ghost faces
  int num_faces, num_remote;
  View<const double*> node_mass;
  View<unsigned char*> status;
  View<double*> gap;

  // Part of the node's surface that opposes a face: A_i, its mean surface mass, both zero if there is none.
  struct Tributary {
    double area = 0; // length^2
    double surface_mass = 0; // mass/area
  };

  KOKKOS_INLINE_FUNCTION bool pushes(global_id, global_id) const { return true; }

  KOKKOS_FORCEINLINE_FUNCTION void prefetchFace(int face) const {
    prefetch(&records(recordOf(face)));
  }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchHead(int node) const { prefetch(&around.offsets(node)); }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchNode(int node) const {
    prefetch(&around.rows(around.offsets(node)));
    prefetch(&node_mass(node));
  }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchAround(int node) const {
    for (int k = around.offsets(node); k < around.offsets(node + 1); ++k)
      prefetch(&records(around.rows(k)));
  }
  KOKKOS_FORCEINLINE_FUNCTION const FaceRecord& recordOfFace(int face) const {
    return records(recordOf(face));
  }
  KOKKOS_INLINE_FUNCTION global_id bodyOf(const FaceAccess&, int face) const {
    return records(recordOf(face)).body;
  }
  KOKKOS_INLINE_FUNCTION global_id idOf(const FaceAccess&, int face) const {
    return records(recordOf(face)).id;
  }

  // False only if test() at ContactTest::activate is false. The first knows no more than where node and face are, the second also how the
  // faces around the node stand.
  KOKKOS_INLINE_FUNCTION bool mayPenetrate(const FaceAccess& faces, int node, int face) const {
    return !isSurelyOutside(rowOf(faces.surface.coordinates_new, node), face);
  }
  KOKKOS_INLINE_FUNCTION bool mayActivate(int node, int face) const {
    return isOpposed(node, records(recordOf(face)).plane.normal,
                     opposedCosine(ContactTest::activate));
  }
  KOKKOS_INLINE_FUNCTION bool isSurelyOutside(const Vec3& x, int face) const {
    return records(recordOf(face))
        .plane.surelyOutside(x, maxOf(lateral_tolerance, FadeRegion::farthest), least_depth);
  }
  KOKKOS_INLINE_FUNCTION void look(const FaceAccess& faces, const ContactHistory& previous,
                                   int count, PersistentContact* contacts) const {
    for (int k = 0; k < count; ++k) {
      const int node = contacts[k].node, face = contacts[k].face;
      faces.prefetchCorners(face, faces.surface.coordinates_new);
      faces.prefetchCorners(face, faces.surface.coordinates_old);
      prefetchAround(node);
    }
    projectPersistentContacts(faces, node_mass, previous, count, contacts);
  }

  KOKKOS_INLINE_FUNCTION bool test(const FaceAccess& faces, int node, int face,
                                   ContactTest test_kind, FaceContact& hit) const {
    const Vec3 x = rowOf(faces.surface.coordinates_new, node);
    return isFacing(x, node, face, test_kind) &&
           accept(faces, face, test_kind, project(faces.quad(face), x), hit) &&
           !((test_kind == ContactTest::activate || test_kind == ContactTest::transfer) &&
             overlapsOnlyAtEdge(faces, node, face, hit));
  }
  // test() at ContactTest::persist.
  KOKKOS_INLINE_FUNCTION bool testAgain(const FaceAccess& faces, const PersistentContact& known,
                                        FaceContact& hit) const {
    const Vec3 x = rowOf(faces.surface.coordinates_new, known.node);
    return isFacing(x, known.node, known.face, ContactTest::persist) &&
           accept(faces, known.face, ContactTest::persist, known.point, hit);
  }
  KOKKOS_INLINE_FUNCTION bool isFacing(const Vec3& x, int node, int face,
                                       ContactTest test_kind) const {
    return !isSurelyOutside(x, face) &&
           isOpposed(node, records(recordOf(face)).plane.normal, opposedCosine(test_kind));
  }
  KOKKOS_INLINE_FUNCTION bool accept(const FaceAccess& faces, int face, ContactTest test_kind,
                                     const FacePoint& point, FaceContact& hit) const {
    if (!(point.gap < -least_depth))
      return false;
    if (!point.activeWithin(lateral_tolerance) &&
        (test_kind == ContactTest::activate ||
         !reachOf(faces, face, faces.quad(face)).covers(point, pastInner(test_kind))))
      return false;
    for (int j = 0; j < 4; ++j)
      hit.weight[j] = point.weight[j];
    for (int d = 0; d < 3; ++d)
      hit.normal[d] = point.normal[d];
    hit.place[0] = point.xi;
    hit.place[1] = point.eta;
    hit.depth = -point.gap;
    hit.face = face;
    hit.is_held = false;
    return true;
  }

  // Whether the node is at a true edge of the face, and its body lies beyond that: bodies that only touch along an edge, such as
  // one that slides over the joint of two others, would else catch on lips of any height. A_i and the face then share no area.
  KOKKOS_INLINE_FUNCTION bool overlapsOnlyAtEdge(const FaceAccess& faces, int node, int face,
                                                 const FaceContact& hit) const {
    if (maxOf(std::fabs(hit.place[0]), std::fabs(hit.place[1])) < 1 - edge_overlap_tolerance)
      return false;
    const Quad quad = faces.quad(face);
    const FadeRegion reach = reachOf(faces, face, quad);
    const Vec3* q = quad.corner;
    const Vec3 along[2] = {(q[1] - q[0]) + (q[2] - q[3]), (q[3] - q[0]) + (q[2] - q[1])};
    for (int d = 0; d < 2; ++d) {
      const double place = hit.place[d];
      if (std::fabs(place) < 1 - edge_overlap_tolerance || !reach.isTrue(d, place))
        continue;
      const double length = norm(along[d]);
      const Vec3 outward = (place > 0 ? 1 / length : -1 / length) * along[d];
      if (isOpposed(node, outward, opposed_cosine))
        return true;
    }
    return false;
  }

  // In |xi|: farther beyond an edge than a node moves at rest.
  static constexpr double past_edge = 1 + 1e-7;
  // Up to here a contact does not ask what there is beyond the edge, whichever it is: isPastInner() and fade() leave it as it is.
  KOKKOS_FORCEINLINE_FUNCTION double farthestSteady() const {
    FadeRegion reach;
    reach.edge_tolerance = edge_tolerance;
    return minOf(past_edge, reach.start());
  }
  // Whether the node is beyond an edge where the body's surface goes on.
  KOKKOS_INLINE_FUNCTION bool isPastInner(const FaceAccess& faces, const FaceContact& hit) const {
    const bool is_past[2] = {std::fabs(hit.place[0]) > past_edge,
                             std::fabs(hit.place[1]) > past_edge};
    if (!(is_past[0] || is_past[1]))
      return false;
    const std::int64_t edges = faces.attributes(hit.face).feature_edges;
    if (edges == FaceAttributes::unknown)
      return false;
    FadeRegion reach;
    reach.mask = static_cast<int>(edges);
    return (is_past[0] && !reach.isTrue(0, hit.place[0])) ||
           (is_past[1] && !reach.isTrue(1, hit.place[1]));
  }
  // Whether the node stands before the face, not behind or beside it.
  KOKKOS_INLINE_FUNCTION bool isOutside(const FaceAccess& faces, int node, int face) const {
    const Quad quad = faces.quad(face);
    const FacePoint point = project(quad, rowOf(faces.surface.coordinates_new, node));
    return point.gap >= 0 && reachOf(faces, face, quad).covers(point, lateral_tolerance);
  }
  KOKKOS_INLINE_FUNCTION void setLevers(const FaceAccess& faces, const Interaction& now, double P,
                                        Vec3 (&lever)[2]) const {
    double along_xi[4], along_eta[4];
    shapeSlopes(now.weight, along_xi, along_eta);
    const Quad quad = faces.quad(now.face_index);
    Vec3 t_xi, t_eta;
    for (int j = 0; j < 4; ++j) {
      t_xi += along_xi[j] * quad.corner[j];
      t_eta += along_eta[j] * quad.corner[j];
    }
    dualBasis(t_xi, t_eta, P, lever);
  }
  // Of the motion along the normal, by xi and eta.
  KOKKOS_INLINE_FUNCTION void slopesOfMotion(const FaceAccess& faces, const Interaction& pair,
                                             int face, double (&slope)[2]) const {
    double along_xi[4], along_eta[4];
    shapeSlopes(pair.weight, along_xi, along_eta);
    slope[0] = slope[1] = 0;
    for (int j = 0; j < 4; ++j) {
      const double motion = dot(pair.normal, faces.cornerMotion(face, j));
      slope[0] += along_xi[j] * motion;
      slope[1] += along_eta[j] * motion;
    }
  }

  KOKKOS_INLINE_FUNCTION ContactPoint pointOf(const FaceAccess&, int node,
                                              const FaceContact&) const {
    return atNode(node);
  }
  KOKKOS_INLINE_FUNCTION double inverseMass(const ContactPoint& point) const {
    return 1.0 / node_mass(point.node[0]);
  }
  KOKKOS_INLINE_FUNCTION double relativeDepth(const FaceAccess&, const FaceContact& hit) const {
    return hit.depth / std::sqrt(records(recordOf(hit.face)).plane.area);
  }
  // Of nodes that are never recorded, status is 0 and gap -0.
  KOKKOS_INLINE_FUNCTION void record(int node, int num_hits, double deepest) const {
    status(node) = static_cast<unsigned char>(num_hits);
    gap(node) = -deepest;
  }

  // k = min(eps A_i, s m_red/dt_ref^2) at the birth, A_i shared by the node's interactions of one normal direction; later no
  // more than the second.
  KOKKOS_INLINE_FUNCTION double stiffnessCap(const EnforcementConfig& config,
                                             const Interaction& now) const {
    return stiffnessCap(config, now.inverse_mass);
  }
  template <class Real>
  KOKKOS_INLINE_FUNCTION Real stiffnessCap(const EnforcementConfig& config,
                                           const Real& inverse_mass) const {
    return config.penalty / (config.reference_step * config.reference_step) / inverse_mass;
  }
  KOKKOS_INLINE_FUNCTION double stiffnessAtBirth(const EnforcementConfig& config,
                                                 const FaceAccess& faces, const Interaction& now,
                                                 const FaceContact (&hits)[max_interactions],
                                                 int num_hits, int h) const {
    const FaceContact& hit = hits[h];
    int sharing = 0;
    for (int other = 0; other < num_hits; ++other)
      if (other == h || dot(hits[other].unitNormal(), hit.unitNormal()) > shared_cosine)
        ++sharing;
    const Tributary part = tributary(now.node, records(recordOf(hit.face)).plane.normal);
    const double face_mass = faces.attributes(hit.face).surface_mass;
    const double scale = config.penalty / (config.reference_step * config.reference_step);
    // eps A_i / scale
    const double by_area = part.area / sharing / (1.0 / part.surface_mass + 1.0 / face_mass);
    return by_area * now.inverse_mass < 1 ? scale * by_area : stiffnessCap(config, now);
  }

  KOKKOS_INLINE_FUNCTION double fadeWeightOf(const FaceAccess& faces, int,
                                             const FaceContact& hit) const {
    const FadeRegion reach = reachOf(faces, hit.face, faces.quad(hit.face));
    return fadeWeightAt(reach, 0, hit.place[0], hit.depth).value *
           fadeWeightAt(reach, 1, hit.place[1], hit.depth).value;
  }
  // w of the force beyond true edges, and what comes with it.
  KOKKOS_INLINE_FUNCTION void fade(const EnforcementConfig& config, const FaceAccess& faces,
                                   const FaceContact& hit, Interaction& now,
                                   FadingForce& fading) const {
    now.fade_weight = 1;
    if (maxOf(std::fabs(hit.place[0]), std::fabs(hit.place[1])) < 1)
      return;
    const Quad quad = faces.quad(hit.face);
    const FadeRegion reach = reachOf(faces, hit.face, quad);
    if (reach.mask == 0)
      return;
    const LateralForce lateral =
        lateralForce(quad, hit.place[0], hit.place[1], now.normal, hit.depth, reach, now.stiffness,
                     maxOf(now.depth, 0.0));
    now.fade_weight = lateral.fade_weight;
    now.first_force += now.stiffness * now.depth * (lateral.fade_weight - 1 + lateral.along_normal);
    fading.on_node = lateral.on_node;
    fading.work_to_end = lateral.work_to_end;
    for (int j = 0; j < 4; ++j)
      fading.normal.on_corner[j] = lateral.on_corner[j];
    const double way = minOf(reach.fadeLength(0, hit.depth) * reach.half[0],
                             reach.fadeLength(1, hit.depth) * reach.half[1]);
    keepWithin(way, config.reference_step, now.inverse_mass, fading);
  }

  KOKKOS_INLINE_FUNCTION int recordOf(int face) const {
    return face < num_faces ? face : face + num_remote;
  }
  KOKKOS_INLINE_FUNCTION FadeRegion reachOf(const FaceAccess& faces, int face,
                                            const Quad& quad) const {
    FadeRegion reach;
    reach.lateral_tolerance = lateral_tolerance;
    reach.edge_tolerance = edge_tolerance;
    const std::int64_t edges = faces.attributes(face).feature_edges;
    if (edges != FaceAttributes::unknown)
      reach.mask = static_cast<int>(edges);
    reach.measure(quad);
    return reach;
  }
  KOKKOS_INLINE_FUNCTION double pastInner(ContactTest test_kind) const {
    return test_kind == ContactTest::retain ? maxOf(0.5, lateral_tolerance) : lateral_tolerance;
  }
  // A contact goes on while a face of the node is turned towards the other at all.
  KOKKOS_INLINE_FUNCTION double opposedCosine(ContactTest test_kind) const {
    return test_kind == ContactTest::activate   ? opposed_cosine
           : test_kind == ContactTest::transfer ? 0.1
                                                : 0;
  }
  KOKKOS_INLINE_FUNCTION static bool opposes(const MeanPlane& plane, const Vec3& normal,
                                             double cosine) {
    return dot(plane.normal, normal) < -cosine;
  }
  // A face of the node opposes the direction; or the node sticks out against it, all of whose faces may be steep.
  KOKKOS_INLINE_FUNCTION bool isOpposed(int node, const Vec3& normal, double cosine) const {
    Vec3 outward;
    for (int k = around.offsets(node); k < around.offsets(node + 1); ++k) {
      const int row = around.rows(k);
      const MeanPlane& plane = records(row).plane;
      if (opposes(plane, normal, cosine))
        return true;
      outward += (around.corner_share(row) * plane.area) * plane.normal;
    }
    const double along = dot(outward, normal);
    return along < 0 && along * along > sharp_cosine * sharp_cosine * dot(outward, outward);
  }
  KOKKOS_INLINE_FUNCTION Tributary tributary(int node, const Vec3& normal) const {
    const Tributary part = tributary(node, normal, opposed_cosine);
    return part.area > 0 ? part : tributary(node, normal, 0);
  }
  // Of the faces that oppose the direction.
  KOKKOS_INLINE_FUNCTION Tributary tributary(int node, const Vec3& normal, double cosine) const {
    Tributary part;
    for (int k = around.offsets(node); k < around.offsets(node + 1); ++k) {
      const int row = around.rows(k);
      const MeanPlane& plane = records(row).plane;
      if (!opposes(plane, normal, cosine))
        continue;
      const double area = around.corner_share(row) * plane.area;
      part.area += area;
      part.surface_mass += around.surface_mass(row) * area;
    }
    if (part.area > 0)
      part.surface_mass /= part.area;
    return part;
  }
};

} // namespace brickwall::contact
