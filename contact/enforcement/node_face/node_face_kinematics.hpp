// Kinematics of node-to-face contact: closest point, opposed-normal rule, and the stiffness from
// the tributary area; eqs. (5) to (12) of theory.md. Fulfils the contract in kinematics.hpp.
#pragma once

#include "contact/enforcement/law/edge_fading.hpp"
#include "contact/enforcement/law/kinematics.hpp"
#include "contact/enforcement/node_face/joint_areas.hpp"
#include "contact/enforcement/node_face/node_surface.hpp"
#include "contact/enforcement/selection/select_interactions.hpp"
#include "contact/surface/project_at_once.hpp"

namespace brickwall::contact {

struct NodeFaceKinematics : NodeSurface {
  // the ledger derives it from the total contact work
  static constexpr bool records_spring_work = false;

  // projectPersistent() fills PersistentContact completely
  static constexpr bool projects_persistent_contacts = true;
  static constexpr bool tests_rows_at_once = false;
  static constexpr bool projects_candidates_at_once = fills_lanes; // by projectCandidates()
  static constexpr int candidates_at_once = 4; // those of a node at a vertex of the other mesh

  // Bodies whose edges overlap by less than this, in half-lengths of a face, pass each other.
  static constexpr double edge_overlap_tolerance = 0.02;

  double lateral_tolerance, edge_tolerance, shared_cosine, least_depth;
  int num_faces, num_remote;
  View<const double*> node_mass;
  JointAreas joints;
  View<int*> status;
  View<double*> gap;

  KOKKOS_INLINE_FUNCTION bool pushes(global_id, global_id) const { return true; }

  KOKKOS_FORCEINLINE_FUNCTION void prefetchFace(int face) const {
    prefetch(&records(recordOf(face)));
  }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchSide(const FaceAccess& faces, int face) const {
    if (faces.isOwn(face))
      prefetch(&faces.surface.face_body(face));
  }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchHead(int node) const {
    prefetch(&adjacent_faces.offsets(node));
  }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchNode(int node) const {
    prefetch(&adjacent_faces.rows(adjacent_faces.offsets(node)));
    prefetch(&node_mass(node));
    joints.prefetch(node);
  }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchAdjacentFaces(int node) const {
    for (int k = adjacent_faces.offsets(node); k < adjacent_faces.offsets(node + 1); ++k)
      prefetch(&records(adjacent_faces.rows(k)));
  }
  KOKKOS_FORCEINLINE_FUNCTION const FaceRecord& recordOfFace(int face) const {
    return records(recordOf(face));
  }
  KOKKOS_INLINE_FUNCTION global_id sideOf(const FaceAccess& faces, int face) const {
    return fills_lanes ? faces.side(face) : records(recordOf(face)).side;
  }
  KOKKOS_INLINE_FUNCTION global_id idOf(const FaceAccess&, int face) const {
    return records(recordOf(face)).id;
  }

  // False only if test() at ContactTest::activate is false. mayPenetrate() uses positions only;
  // mayActivate() also the faces around the node.
  KOKKOS_INLINE_FUNCTION bool mayPenetrate(const FaceAccess& faces, int node, int face) const {
    return !isSurelyOutside(rowOf(faces.surface.coordinates_new, node), face,
                            ContactTest::activate);
  }
  KOKKOS_INLINE_FUNCTION bool mayActivate(int node, int face) const {
    return isOpposing(node, face, ContactTest::activate);
  }
  // By place, a pair that passes ContactTest::activate also passes transfer. By orientation it may
  // not, since opposed_cosine may be less than that of transfer.
  KOKKOS_INLINE_FUNCTION unsigned passedTests(const FaceAccess& faces, int node, int face,
                                              FaceContact& contact) const {
    const Vec3 x = rowOf(faces.surface.coordinates_new, node);
    if (isSurelyOutside(x, face, ContactTest::transfer))
      return 0;
    const bool activates = isFacing(faces, node, face, ContactTest::activate);
    const bool transfers = isOpposing(node, face, ContactTest::transfer);
    if (!activates && !transfers)
      return 0;
    const FacePoint point = project(faces.quad(face), x);
    if (!accept(faces, face, ContactTest::transfer, point, contact))
      return 0;
    unsigned passed = transfers ? bitOf(ContactTest::transfer) : 0;
    if (activates && point.activeWithin(lateral_tolerance) &&
        !overlapsOnlyAtEdge(faces, node, face, contact))
      passed |= bitOf(ContactTest::activate);
    return passed;
  }
  // Contacts become active only within lateral_tolerance, where a warped face reaches less far out
  // of its mean plane. Half of least_depth there is for rounding.
  KOKKOS_INLINE_FUNCTION bool isSurelyOutside(const Vec3& x, int face,
                                              ContactTest test_kind) const {
    const MeanPlane& plane = records(recordOf(face)).plane;
    return plane.surelyOutside(x, maxOf(lateral_tolerance, FadeRegion::max_excess), least_depth) ||
           (test_kind == ContactTest::activate &&
            plane.surelyOutside(x, lateral_tolerance, 0.5 * least_depth));
  }
  KOKKOS_INLINE_FUNCTION void projectPersistent(const FaceAccess& faces,
                                                const ContactHistory& previous, int count,
                                                PersistentContact* contacts) const {
    for (int k = 0; k < count; ++k) {
      const int node = contacts[k].node, face = contacts[k].face;
      faces.prefetchCorners(face, faces.surface.coordinates_new);
      faces.prefetchCorners(face, faces.surface.coordinates_old);
      prefetchAdjacentFaces(node);
    }
    projectPersistentContacts(faces, node_mass, previous, count, contacts);
  }

  KOKKOS_INLINE_FUNCTION bool test(const FaceAccess& faces, int node, int face,
                                   ContactTest test_kind, FaceContact& contact) const {
    const Vec3 x = rowOf(faces.surface.coordinates_new, node);
    return isFacing(faces, node, face, test_kind) &&
           testPoint(faces, node, face, test_kind, project(faces.quad(face), x), contact);
  }
  // test() from the closest point of a face that is facing the node.
  KOKKOS_INLINE_FUNCTION bool testPoint(const FaceAccess& faces, int node, int face,
                                        ContactTest test_kind, const FacePoint& point,
                                        FaceContact& contact) const {
    return accept(faces, face, test_kind, point, contact) &&
           !(test_kind == ContactTest::activate && overlapsOnlyAtEdge(faces, node, face, contact));
  }
  // Host code; a template, since builds for devices have no packs.
  template <int width = candidates_at_once>
  void projectCandidates(const FaceAccess& faces, int node, int count, const int* candidates,
                         FacePoint* points) const {
    projectAtOnce<width>([&](int k) { return faces.quad(candidates[k]); }, count,
                         rowOf(faces.surface.coordinates_new, node), points);
  }
  KOKKOS_INLINE_FUNCTION bool testPersistent(const FaceAccess& faces,
                                             const PersistentContact& persistent,
                                             ContactTest test_kind, FaceContact& contact) const {
    return accept(faces, persistent.face, test_kind, persistent.point, contact) &&
           (test_kind == ContactTest::release ||
            isOpposing(persistent.node, persistent.face, test_kind));
  }
  KOKKOS_INLINE_FUNCTION bool acceptPersistent(const FaceAccess& faces,
                                               const PersistentContact& persistent,
                                               FaceContact& contact) const {
    return accept(faces, persistent.face, ContactTest::persist, persistent.point, contact);
  }
  // True only where a contact whose node opposes the face persists without fading:
  // acceptPersistent() is true, isBeyondInnerEdge() and mayFade() are false. `reach`: reachOf() the
  // face.
  template <class Real>
  KOKKOS_INLINE_FUNCTION auto staysInside(const persistent_contact::Found<Real>& found,
                                          const Real& reach) const {
    const Real outermost = maxOf(magnitude(Real(found.xi)), magnitude(Real(found.eta)));
    return (Real(found.is_found) == Real(1.0)) & (Real(found.gap) < Real(-least_depth)) &
           (Real(found.excess) <= Real(lateral_tolerance)) & (outermost <= reach);
  }
  KOKKOS_INLINE_FUNCTION bool isFacing(const FaceAccess& faces, int node, int face,
                                       ContactTest test_kind) const {
    return !isSurelyOutside(rowOf(faces.surface.coordinates_new, node), face, test_kind) &&
           isOpposing(node, face, test_kind);
  }
  KOKKOS_INLINE_FUNCTION bool isOpposing(int node, int face, ContactTest test_kind) const {
    return isOpposed(node, records(recordOf(face)).plane.normal, opposedCosine(test_kind));
  }
  KOKKOS_INLINE_FUNCTION bool accept(const FaceAccess& faces, int face, ContactTest test_kind,
                                     const FacePoint& point, FaceContact& contact) const {
    const bool releases = test_kind == ContactTest::release;
    if (releases ? !(point.valid && point.has_parameters) : !(point.gap < -least_depth))
      return false;
    if (!releases && !point.activeWithin(lateral_tolerance) &&
        (test_kind == ContactTest::activate ||
         !fadeRegionOf(faces, face, faces.quad(face)).covers(point, innerTolerance(test_kind))))
      return false;
    for (int j = 0; j < 4; ++j)
      contact.weight[j] = point.weight[j];
    for (int d = 0; d < 3; ++d)
      contact.normal[d] = point.normal[d];
    contact.place[0] = point.xi;
    contact.place[1] = point.eta;
    contact.depth = -point.gap;
    contact.face = face;
    contact.is_retained = releases;
    return true;
  }

  // Whether the node is at a true edge of the face and its body lies beyond that edge. Bodies that
  // meet only along an edge, such as one that slides over the joint between two others, would
  // otherwise catch on steps of any height; A_i and the face share no area then.
  KOKKOS_INLINE_FUNCTION bool overlapsOnlyAtEdge(const FaceAccess& faces, int node, int face,
                                                 const FaceContact& contact) const {
    if (maxOf(std::fabs(contact.place[0]), std::fabs(contact.place[1])) <
        1 - edge_overlap_tolerance)
      return false;
    FadeRegion region;
    region.mask = faces.attributes(face).edgesOfBody();
    if (region.mask == 0)
      return false;
    const Quad quad = faces.quad(face);
    const Vec3* q = quad.corner;
    for (int d = 0; d < 2; ++d) {
      // no arrays with the index d: these would be in memory on devices
      const double place = d == 0 ? contact.place[0] : contact.place[1];
      if (std::fabs(place) < 1 - edge_overlap_tolerance || !region.isTrue(d, place))
        continue;
      const Vec3 along = d == 0 ? (q[1] - q[0]) + (q[2] - q[3]) : (q[3] - q[0]) + (q[2] - q[1]);
      const double length = norm(along);
      const Vec3 outward = (place > 0 ? 1 / length : -1 / length) * along;
      if (liesBeyond(node, outward))
        return true;
    }
    return false;
  }

  // Beyond an inner edge of a flat surface contacts keep their face as far as where fading starts
  // beyond true edges, since most nodes of pressed, matching meshes vibrate within it. On a bent
  // surface the gap would change by the distance times the angle.
  static constexpr double past_bent_edge = 1 + 1e-3; // in |xi|
  KOKKOS_INLINE_FUNCTION double reachOf(const FaceAttributes& face) const {
    FadeRegion region;
    region.edge_tolerance = edge_tolerance;
    return face.isBent() ? minOf(past_bent_edge, region.start()) : region.start();
  }
  // Whether the node is so far beyond an edge where the body's surface continues that another face
  // may take over.
  KOKKOS_INLINE_FUNCTION bool isBeyondInnerEdge(const FaceAccess& faces,
                                                const FaceContact& contact) const {
    const FaceAttributes& attributes = faces.attributes(contact.face);
    if (attributes.feature_edges == FaceAttributes::unknown)
      return false;
    const double reach = reachOf(attributes);
    const bool is_past[2] = {std::fabs(contact.place[0]) > reach,
                             std::fabs(contact.place[1]) > reach};
    FadeRegion region;
    region.mask = attributes.trueEdges();
    return (is_past[0] && !region.isTrue(0, contact.place[0])) ||
           (is_past[1] && !region.isTrue(1, contact.place[1]));
  }
  // Whether the node is in front of a face that continues the surface of the contact's face. It has
  // then left the body, though it is behind the plane of the contact's face. On a flat surface it
  // may be about to return within the lateral tolerance.
  static constexpr double smooth_cosine = 0.7; // a little less than that of feature edges
  KOKKOS_INLINE_FUNCTION bool hasLeftThrough(const FaceAccess& faces, int node, int face,
                                             const FaceContact& contact) const {
    const double outermost = maxOf(std::fabs(contact.place[0]), std::fabs(contact.place[1]));
    return face != contact.face &&
           (outermost > 1 + lateral_tolerance || faces.attributes(contact.face).isBent()) &&
           dot(records(recordOf(face)).plane.normal, contact.unitNormal()) > smooth_cosine &&
           isInFront(faces, face,
                     project(faces.quad(face), rowOf(faces.surface.coordinates_new, node)));
  }
  // Whether a node that projects onto the face at `point` is in front of it, not behind or beside
  // it.
  KOKKOS_INLINE_FUNCTION bool isInFront(const FaceAccess& faces, int face,
                                        const FacePoint& point) const {
    return point.gap >= 0 &&
           fadeRegionOf(faces, face, faces.quad(face)).covers(point, lateral_tolerance);
  }
  KOKKOS_INLINE_FUNCTION void findTangents(const FaceAccess& faces, const Interaction& pair,
                                           int face, Vec3 (&tangent)[2], Vec3 (&motion)[2]) const {
    double along[2][4];
    shapeDerivatives(pair.weight, along[0], along[1]);
    const Quad quad = faces.quad(face);
    for (int j = 0; j < 4; ++j) {
      const Vec3 of_corner = faces.cornerMotion(face, j);
      for (int a = 0; a < 2; ++a) {
        tangent[a] += along[a][j] * quad.corner[j];
        motion[a] += along[a][j] * of_corner;
      }
    }
  }

  KOKKOS_INLINE_FUNCTION ContactPoint pointOf(const FaceAccess&, int node,
                                              const FaceContact&) const {
    return atNode(node);
  }
  KOKKOS_INLINE_FUNCTION double inverseMass(const ContactPoint& point) const {
    return 1.0 / node_mass(point.node[0]);
  }
  KOKKOS_INLINE_FUNCTION double relativeDepth(const FaceAccess&, const FaceContact& contact) const {
    return contact.depth / std::sqrt(areaOf(contact.face));
  }
  KOKKOS_FORCEINLINE_FUNCTION double areaOf(int face) const {
    return records(recordOf(face)).plane.area;
  }
  // Nodes that are never recorded keep status 0 and gap -0.
  KOKKOS_INLINE_FUNCTION void record(int node, int num_contacts, double deepest) const {
    status(node) = num_contacts;
    gap(node) = -deepest;
  }

  // k = min(eps A_i, s m_red/dt_ref^2) at activation, eqs. (11) and (12), with A_i divided among
  // the node's contacts of one normal direction, or that of its joint; later at most the second
  // bound.
  template <class Real>
  KOKKOS_INLINE_FUNCTION Real stiffnessCap(const EnforcementConfig& config,
                                           const Real& inverse_mass) const {
    return config.penalty / (config.reference_step * config.reference_step) / inverse_mass;
  }
  KOKKOS_FORCEINLINE_FUNCTION double jointArea(int node, int face) const {
    return joints.areaOf(node, records(recordOf(face)).side);
  }
  KOKKOS_FORCEINLINE_FUNCTION double capFactor(int node, int face) const {
    return jointArea(node, face) > 0 ? JointAreas::cap_factor : 1.0;
  }
  KOKKOS_INLINE_FUNCTION double stiffnessAtActivation(const EnforcementConfig& config,
                                                      const FaceAccess& faces,
                                                      const FaceContact& contact,
                                                      const FaceContact* contacts,
                                                      int num_contacts) const {
    int sharing = 0;
    for (const FaceContact* other = contacts; other < contacts + num_contacts; ++other)
      if (other == &contact || dot(other->unitNormal(), contact.unitNormal()) > shared_cosine)
        ++sharing;
    const Tributary part = tributary(contact.node, records(recordOf(contact.face)).plane.normal);
    const double face_mass = faces.attributes(contact.face).surface_mass;
    const double scale = config.penalty / (config.reference_step * config.reference_step);
    const double joint_area = jointArea(contact.node, contact.face);
    const double area =
        joint_area > 0 ? JointAreas::stiffness_share * joint_area : part.area / sharing;
    const double by_area = area / (1.0 / part.surface_mass + 1.0 / face_mass); // eps A_i / scale
    const double factor = joint_area > 0 ? JointAreas::cap_factor : 1.0;
    return by_area * contact.inverse_mass < factor
               ? scale * by_area
               : factor * stiffnessCap(config, contact.inverse_mass);
  }

  KOKKOS_INLINE_FUNCTION double fadeWeightOf(const FaceAccess& faces, int,
                                             const FaceContact& contact) const {
    const FadeRegion region = fadeRegionOf(faces, contact.face, faces.quad(contact.face));
    return fadeWeightAt(region, 0, contact.place[0], contact.depth).value *
           fadeWeightAt(region, 1, contact.place[1], contact.depth).value;
  }
  // False only if w is 1 at this place.
  KOKKOS_INLINE_FUNCTION bool mayFade(const FaceContact& contact) const {
    FadeRegion region;
    region.edge_tolerance = edge_tolerance;
    return maxOf(std::fabs(contact.place[0]), std::fabs(contact.place[1])) > region.start();
  }
  // Fade weight beyond true edges, with the fading force; eqs. (24) to (26).
  KOKKOS_INLINE_FUNCTION void fade(const EnforcementConfig& config, const FaceAccess& faces,
                                   const FaceContact& contact, Interaction& now,
                                   FadingForce& fading) const {
    now.fade_weight = 1;
    if (maxOf(std::fabs(contact.place[0]), std::fabs(contact.place[1])) < 1)
      return;
    const Quad quad = faces.quad(contact.face);
    const FadeRegion region = fadeRegionOf(faces, contact.face, quad);
    if (region.mask == 0)
      return;
    const LateralForce lateral =
        lateralForce(quad, contact.place[0], contact.place[1], now.normal, contact.depth, region,
                     now.stiffness, maxOf(now.depth, 0.0));
    now.fade_weight = lateral.fade_weight;
    now.first_force += now.stiffness * now.depth * (lateral.fade_weight - 1 + lateral.along_normal);
    fading.on_node = lateral.on_node;
    fading.work_to_end = lateral.work_to_end;
    for (int j = 0; j < 4; ++j)
      fading.normal.on_corner[j] = lateral.on_corner[j];
    const double fade_length =
        minOf(region.fadeLength(0, contact.depth).value * region.half_length[0],
              region.fadeLength(1, contact.depth).value * region.half_length[1]);
    limitLateralMotion(fade_length, config.reference_step, now.inverse_mass, fading);
  }

  KOKKOS_INLINE_FUNCTION int recordOf(int face) const {
    return face < num_faces ? face : face + num_remote;
  }
  KOKKOS_INLINE_FUNCTION FadeRegion fadeRegionOf(const FaceAccess& faces, int face,
                                                 const Quad& quad) const {
    FadeRegion region;
    region.lateral_tolerance = lateral_tolerance;
    region.edge_tolerance = edge_tolerance;
    region.mask = faces.attributes(face).trueEdges();
    region.measure(quad);
    return region;
  }
  KOKKOS_INLINE_FUNCTION double innerTolerance(ContactTest test_kind) const {
    return test_kind == ContactTest::retain ? maxOf(0.5, lateral_tolerance) : lateral_tolerance;
  }
  // A persistent contact continues while a face of the node faces the other one at all.
  KOKKOS_INLINE_FUNCTION double opposedCosine(ContactTest test_kind) const {
    return test_kind == ContactTest::activate   ? opposed_cosine
           : test_kind == ContactTest::transfer ? 0.1
                                                : 0;
  }
};

template struct KinematicsContract<NodeFaceKinematics>;

} // namespace brickwall::contact
