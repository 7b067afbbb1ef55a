// Kinematics of edge-to-edge contact: convex edges against convex edges that they cross; eqs. (29)
// to (32) of theory.md. Node-to-face contact detects edges that cross between their nodes only when
// a node is inside, half an element too late. Fulfils the contract in kinematics.hpp.
#pragma once

#include "contact/enforcement/edge_edge/edge_activation.hpp"
#include "contact/enforcement/edge_edge/edge_geometry.hpp"
#include "contact/enforcement/law/edge_fading.hpp"
#include "contact/enforcement/law/kinematics.hpp"
#include "contact/enforcement/selection/select_interactions.hpp"

namespace brickwall::contact {

struct EdgeEdgeKinematics {
  static constexpr bool records_spring_work = true;
  // projectPersistent() fills last_motion only
  static constexpr bool projects_persistent_contacts = false;
  static constexpr bool tests_rows_at_once = true; // by rowsThatMayActivate()
  static constexpr bool projects_candidates_at_once = false;
  // Edges at smaller sines, to each other or to a face, are left to node-to-face contact: a node
  // half an element away is inside before the penetration reaches 0.015 elements.
  static constexpr double least_sine = 0.03;
  static constexpr double parallel_sine = 0.2; // below it a contact may be retained at fixed points
  // An edge that spans a side of the other body, or a corner of it, has no node over that side
  // which could be inside, so it becomes active there too; otherwise bars narrower than their
  // elements would pass through each other, and cubes of one element that are turned against each
  // other. The edge must end beyond the side by this many lateral tolerances of half its width;
  // nearer nodes are in contact with the side.
  static constexpr double side_overhang = 0.8;
  // Edges that have crossed less deeply than this, relative to the shorter edge, may become active
  // whether or not they had met (EdgesFacing::hadMet()). Edges of bricks that lie flat on each other
  // cross at zero depth and angle; once they have rotated by `least_sine`, nodes an element away
  // have let them in by as much.
  static constexpr double shallow_depth = 0.06;
  // how far the pushing edge continues over the next one, in lengths of the edge
  static constexpr double overhang = 1.0;
  // an active contact ends when the normal is this far outside a cone
  static constexpr double max_outside = 0.8;
  // relative to a node's, since edges act in addition to nodes
  static constexpr double stiffness_share = 0.5;
  // Relative to the shorter edge: a deeper pair did not come through these edges when it is found,
  // and no contact continues deeper.
  static constexpr double max_activation_depth = 0.5, max_depth = 1;

  double lateral_tolerance, edge_tolerance;
  int num_corners; // rows below it are ends of edges; row num_corners + e is edge e
  View<const double*> node_mass; // [corner]
  StructArray<Interaction> previous;
  EdgeRecords records;

  // Each pair of edges is tested once: the edge of the lower body pushes.
  KOKKOS_INLINE_FUNCTION bool pushes(global_id own_body, global_id body) const {
    return own_body <= body;
  }
  KOKKOS_INLINE_FUNCTION int edgeOf(int node) const { return node - num_corners; }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchFace(int edge) const { prefetch(&records.of(edge)); }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchSide(const FaceAccess&, int edge) const {
    prefetchFace(edge);
  }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchHead(int node) const {
    prefetch(&records.of(edgeOf(node)));
  }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchNode(int) const {}
  KOKKOS_INLINE_FUNCTION global_id sideOf(const FaceAccess&, int edge) const {
    return records.of(edge).side;
  }
  KOKKOS_INLINE_FUNCTION global_id idOf(const FaceAccess&, int edge) const {
    return records.of(edge).id;
  }

  // The edge vectors at x^{n+1}, and the vector from the first end of `other` to that of `own`.
  KOKKOS_INLINE_FUNCTION static void lines(const FaceAccess& faces, int own, int other, Vec3& da,
                                           Vec3& db, Vec3& between) {
    const auto& nodes = faces.surface.coordinates_new;
    const auto& ghosts = faces.ghosts.coordinates_new;
    const Vec3 a = faces.corner(own, 0, nodes, ghosts), b = faces.corner(other, 0, nodes, ghosts);
    da = faces.corner(own, 1, nodes, ghosts) - a;
    db = faces.corner(other, 1, nodes, ghosts) - b;
    between = a - b;
  }

  // Bit r: row rows[r] holds an edge that its own edge may come into contact with; 0 only if test()
  // at ContactTest::activate is false for all edges that it pushes. Only rows of the bits in
  // `requested` are tested.
  KOKKOS_INLINE_FUNCTION unsigned rowsThatMayActivate(const FaceAccess& faces,
                                                      const CandidatePairs& pairs,
                                                      const std::int64_t* rows, int count,
                                                      unsigned requested) const {
    EdgeActivationTest<Lanes> activation_test{faces, records, activationLimits(), 0, {}, {}};
    for (int r = 0; r < count; ++r) {
      if (!(requested >> r & 1u))
        continue;
      const int own = edgeOf(pairs.node(rows[r]));
      const global_id body = bodyOfSide(records.of(own).side);
      for (std::int64_t p = pairs.begin(rows[r]); p < pairs.end(rows[r]); ++p) {
        const int other = pairs.faces(p);
        if (pushes(body, bodyOfSide(records.of(other).side)))
          activation_test.add(r, own, other);
      }
    }
    activation_test.finish();
    return activation_test.rows;
  }
  // Loaded contacts are projected by test().
  KOKKOS_INLINE_FUNCTION void projectPersistent(const FaceAccess& faces,
                                                const ContactHistory& history, int count,
                                                PersistentContact* contacts) const {
    for (int k = 0; k < count; ++k) {
      const Interaction& last = history.interactions(contacts[k].previous);
      contacts[k].last_motion = faces.relativeMotion(last.point, contacts[k].face, last.weight);
    }
  }
  KOKKOS_INLINE_FUNCTION bool testPersistent(const FaceAccess& faces,
                                             const PersistentContact& persistent,
                                             ContactTest test_kind, FaceContact& contact) const {
    return test(faces, persistent.node, persistent.face, test_kind, contact);
  }

  KOKKOS_INLINE_FUNCTION bool test(const FaceAccess& faces, int node, int other,
                                   ContactTest test_kind, FaceContact& contact) const {
    const int own = edgeOf(node);
    Vec3 da, db, between;
    lines(faces, own, other, da, db, between);
    const Crossing crossing(da, db, between);
    if (test_kind == ContactTest::release) {
      contact.is_retained = true;
      const Interaction& last = previous(contact.previous);
      return last.fade_weight == 1 &&
             (crossing.isAcross(parallel_sine)
                  ? releaseAtCrossing(da, db, between, crossing, last, other, contact)
                  : retainPoints(da, db, between, last, other, contact, true));
    }
    const bool is_retained = test_kind == ContactTest::retain;
    contact.is_retained = is_retained && (previous(contact.previous).is_retained ||
                                          !crossing.isAcross(parallel_sine));
    if (contact.is_retained)
      return retainPoints(da, db, between, previous(contact.previous), other, contact);
    const bool continues = test_kind == ContactTest::persist || is_retained;
    const double aa = crossing.aa, bb = crossing.bb;
    // A retained contact continues at the crossing once the angle is large enough.
    if (continues && previous(contact.previous).is_retained && !crossing.isAcross(parallel_sine))
      return false;
    if (!crossing.isAcross(least_sine) ||
        crossing.isFarBeyond(start() + overhang)) // beyond the limits of isOn()
      return false;
    const double s = crossing.s, t = crossing.t;
    const Vec3 across = cross(da, db);
    Vec3 normal = (1 / norm(across)) * across;
    double depth = -dot(between, normal);
    const double limit = contact.previous < 0 ? max_activation_depth : max_depth;
    if (!(depth * depth < limit * limit * minOf(aa, bb)))
      return false;
    const CrossedEdge crossed_b(faces, other, faces.quad(other), t);
    if (dot(normal, crossed_b.cone.first + crossed_b.cone.second) < 0) {
      normal = -normal;
      depth = -depth;
    }
    if (!(depth > 0) ||
        !isOn(continuedEnds(faces, own), s, depth, std::sqrt(aa), contact.previous >= 0,
              overhang) ||
        !isOn(continuedEnds(faces, other), t, depth, std::sqrt(bb), continues,
              is_retained ? overhang : lateral_tolerance))
      return false;
    const CrossedEdge crossed_a(faces, own, faces.quad(own), s);
    const bool faces_out = continues ? minOf(crossed_a.cone.depthOf(-normal),
                                             crossed_b.cone.depthOf(normal)) > -max_outside
                                     : facing().holds(crossed_a, crossed_b, normal);
    if (!faces_out || sharesNode(faces, own, other))
      return false;
    if (contact.previous < 0 && depth * depth > shallow_depth * shallow_depth * minOf(aa, bb) &&
        facing().hadMet(faces, own, other, normal))
      return false;
    setContact(s, t, normal, depth, other, contact);
    return true;
  }
  // In widths of a side, or lengths of its edge.
  KOKKOS_INLINE_FUNCTION double sideOverhang() const {
    return 0.5 * side_overhang * lateral_tolerance;
  }
  KOKKOS_INLINE_FUNCTION EdgeActivationLimits activationLimits() const {
    return {least_sine, 0.5 * lateral_tolerance, max_activation_depth, sideOverhang()};
  }
  KOKKOS_INLINE_FUNCTION EdgesFacing facing() const { return {least_sine, sideOverhang()}; }
  KOKKOS_INLINE_FUNCTION static void setContact(double s, double t, const Vec3& normal,
                                                double depth, int other, FaceContact& contact) {
    contact.weight[0] = 1 - t, contact.weight[1] = t;
    contact.weight[2] = contact.weight[3] = 0;
    for (int d = 0; d < 3; ++d)
      contact.normal[d] = normal[d];
    contact.place[0] = s;
    contact.depth = depth;
    contact.face = other;
  }
  // A contact that slides out of reach, or whose edges separate, is released along the common
  // normal of the edges: along the vector between two points it would hold on to the slide.
  KOKKOS_INLINE_FUNCTION bool releaseAtCrossing(const Vec3& da, const Vec3& db, const Vec3& between,
                                                const Crossing& crossing, const Interaction& last,
                                                int other, FaceContact& contact) const {
    const Vec3 across = cross(da, db);
    const double sign = dot(across, last.normal) < 0 ? -1 : 1;
    const Vec3 normal = (sign / norm(across)) * across;
    const double depth = -dot(between, normal);
    if (crossing.isFarBeyond(start() + 1.5 * overhang) ||
        !(depth * depth < max_depth * max_depth * minOf(crossing.aa, crossing.bb)))
      return false;
    setContact(crossing.s, crossing.t, normal, depth, other, contact);
    return true;
  }
  // Loaded edges may turn parallel, and their crossing point runs away. The contact is then
  // retained between the two points where it was last, with the force along the vector between them
  // (so that it has no couple and derives from an energy), until that vector vanishes or reverses;
  // a contact that is released continues beyond (`may_be_apart`), with a negative depth.
  KOKKOS_INLINE_FUNCTION static bool retainPoints(const Vec3& da, const Vec3& db,
                                                  const Vec3& between, const Interaction& last,
                                                  int other, FaceContact& contact,
                                                  bool may_be_apart = false) {
    const double s = last.point.share, t = last.weight[1];
    const Vec3 between_points = (t * db - s * da) - between;
    const double square = dot(between_points, between_points);
    const double along = dot(between_points, last.normal);
    if (!((along > 0 || (may_be_apart && along < 0)) &&
          square < max_depth * max_depth * minOf(dot(da, da), dot(db, db))))
      return false;
    const double depth = along > 0 ? std::sqrt(square) : -std::sqrt(square);
    setContact(s, t, (1 / depth) * between_points, depth, other, contact);
    return true;
  }

  // Beyond the end of a brick's edge an active contact fades out, as beyond the edges of faces,
  // from start() on over the fade length, in lengths of the edge; eqs. (24) and (25).
  static constexpr double fade_depth_ratio = 3;
  KOKKOS_INLINE_FUNCTION double start() const { return 0.1 * edge_tolerance; }
  KOKKOS_INLINE_FUNCTION FadeLength fadeLength(double depth, double length) const {
    return FadeLength::at(fade_depth_ratio * depth / length, 0.4 * edge_tolerance, 0.5);
  }
  // Whether the point at weight `s` is on the edge: exactly at an end where another edge continues,
  // otherwise with a tolerance. An active contact continues a little over the next edge, since
  // loaded edges bend; the pushing edge continues over all of it, so that a short slide does not
  // end the contact.
  KOKKOS_INLINE_FUNCTION bool isOn(int continued_ends, double s, double depth, double length,
                                   bool has_begun, double inner_tolerance) const {
    const double at_end =
        has_begun ? start() + fadeLength(depth, length).value : 0.5 * lateral_tolerance;
    const double over = has_begun ? inner_tolerance : 0;
    return s >= -(continued_ends & 1 ? over : at_end) &&
           s <= 1 + (continued_ends & 2 ? over : at_end);
  }
  KOKKOS_INLINE_FUNCTION static int continuedEnds(const FaceAccess& faces, int edge) {
    return static_cast<int>(faces.attributes<EdgeAttributes>(edge).goes_on);
  }
  KOKKOS_INLINE_FUNCTION FadeWeight endFadeWeight(int continued_ends, double s, double depth,
                                                  double length) const {
    FadeWeight fade_weight;
    const bool at_second = s > 0.5;
    const double beyond = (at_second ? s - 1 : -s) - start();
    if (beyond <= 0 || (continued_ends & (at_second ? 2 : 1)))
      return fade_weight;
    const FadeLength fade_length = fadeLength(depth, length);
    fade_weight.set(beyond, at_second, fade_length, fade_length.slope * fade_depth_ratio / length);
    return fade_weight;
  }

  // Edges slide over bends (isOn()), and end their contacts before they separate.
  KOKKOS_INLINE_FUNCTION bool isBeyondInnerEdge(const FaceAccess&, const FaceContact&) const {
    return false;
  }
  KOKKOS_INLINE_FUNCTION bool hasLeftThrough(const FaceAccess&, int, int,
                                             const FaceContact&) const {
    return false;
  }
  KOKKOS_INLINE_FUNCTION bool isInFront(const FaceAccess&, int, const FacePoint&) const {
    return false;
  }
  KOKKOS_INLINE_FUNCTION void findTangents(const FaceAccess& faces, const Interaction& pair,
                                           int face, Vec3 (&tangent)[2], Vec3 (&motion)[2]) const {
    const int edges[2] = {edgeOf(pair.node), face};
    for (int a = 0; a < 2; ++a) {
      const Quad quad = faces.quad(edges[a]);
      tangent[a] = quad.corner[1] - quad.corner[0];
      motion[a] = faces.cornerMotion(edges[a], 1) - faces.cornerMotion(edges[a], 0);
    }
  }

  KOKKOS_INLINE_FUNCTION ContactPoint pointOf(const FaceAccess& faces, int node,
                                              const FaceContact& contact) const {
    ContactPoint point;
    point.node[0] = faces.surface.face_to_nodes(edgeOf(node), 0);
    point.node[1] = faces.surface.face_to_nodes(edgeOf(node), 1);
    point.share = contact.place[0];
    return point;
  }
  KOKKOS_INLINE_FUNCTION double inverseMass(const ContactPoint& point) const {
    return (1 - point.share) * (1 - point.share) / node_mass(point.node[0]) +
           point.share * point.share / node_mass(point.node[1]);
  }
  KOKKOS_INLINE_FUNCTION double relativeDepth(const FaceAccess& faces,
                                              const FaceContact& contact) const {
    const Quad quad = faces.quad(contact.face);
    return contact.depth / norm(quad.corner[1] - quad.corner[0]);
  }
  KOKKOS_INLINE_FUNCTION void record(int, int, double) const {}

  // 0 if all motions are prescribed.
  template <class Real>
  KOKKOS_INLINE_FUNCTION Real stiffnessCap(const EnforcementConfig& config,
                                           const Real& inverse_mass) const {
    const Real cap = stiffness_share * config.penalty /
                     (config.reference_step * config.reference_step * inverse_mass);
    return where(inverse_mass > Real(0.0), cap, Real(0.0));
  }
  KOKKOS_FORCEINLINE_FUNCTION double capFactor(int, int) const { return 1; }
  KOKKOS_INLINE_FUNCTION double stiffnessAtActivation(const EnforcementConfig& config,
                                                      const FaceAccess&, const FaceContact& contact,
                                                      const FaceContact*, int) const {
    return stiffnessCap(config, contact.inverse_mass);
  }

  // U = k w(s) w(t) p^2/2, with s and t at the closest points of the two lines, eq. (32): r =
  // x_own(s) - x_other(t) is perpendicular to both, so that a ds - b dt = -(D . d_own + r . delta
  // d_own), b ds - c dt = -(D . d_other + r . delta d_other), with D the motion of one point with
  // respect to the other, and a, b, c the products of d_own and d_other.
  KOKKOS_INLINE_FUNCTION double fadeWeightOf(const FaceAccess& faces, int node,
                                             const FaceContact& contact) const {
    const int own = edgeOf(node);
    const Quad one = faces.quad(own), other = faces.quad(contact.face);
    return endFadeWeight(continuedEnds(faces, own), contact.place[0], contact.depth,
                         norm(one.corner[1] - one.corner[0]))
               .value *
           endFadeWeight(continuedEnds(faces, contact.face), contact.weight[1], contact.depth,
                         norm(other.corner[1] - other.corner[0]))
               .value;
  }
  // False only if w is 1 at these points.
  KOKKOS_INLINE_FUNCTION bool mayFade(const FaceContact& contact) const {
    const double s = contact.place[0], t = contact.weight[1];
    return maxOf(maxOf(-s, s - 1), maxOf(-t, t - 1)) > start();
  }
  KOKKOS_INLINE_FUNCTION void fade(const EnforcementConfig& config, const FaceAccess& faces,
                                   const FaceContact& contact, Interaction& now,
                                   FadingForce& fading) const {
    const int own = edgeOf(now.node);
    const double s = contact.place[0], t = contact.weight[1];
    now.fade_weight = 1;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1)
      return;
    const Quad one = faces.quad(own), other = faces.quad(contact.face);
    const Vec3 da = one.corner[1] - one.corner[0], db = other.corner[1] - other.corner[0];
    const double a = dot(da, da), b = dot(da, db), c = dot(db, db);
    const double length_a = std::sqrt(a), length_b = std::sqrt(c);
    const FadeWeight at_s = endFadeWeight(continuedEnds(faces, own), s, contact.depth, length_a);
    const FadeWeight at_t =
        endFadeWeight(continuedEnds(faces, contact.face), t, contact.depth, length_b);
    const double p = maxOf(now.depth, 0.0), energy = 0.5 * now.stiffness * p * p;
    now.fade_weight = at_s.value * at_t.value;
    now.first_force += now.stiffness * now.depth *
                       (now.fade_weight - 1 +
                        0.5 * p * (at_s.depth_slope * at_t.value + at_s.value * at_t.depth_slope));
    const double g_s = energy * at_s.slope * at_t.value, g_t = energy * at_s.value * at_t.slope;
    const double determinant = maxOf(a * c - b * b, least_sine * least_sine * a * c);
    const double q_own = (g_s * c + g_t * b) / determinant;
    const double q_other = -(g_s * b + g_t * a) / determinant;
    fading.on_node = q_own * da + q_other * db;
    fading.work_to_end = energy * changeToZero(at_s, at_t);
    fading.normal.on_end = -q_own * contact.depth; // r = -P n
    fading.normal.on_corner[0] = q_other * contact.depth;
    fading.normal.on_corner[1] = -fading.normal.on_corner[0];
    const double shorter = minOf(fadeLength(contact.depth, length_a).value * length_a,
                                 fadeLength(contact.depth, length_b).value * length_b);
    limitLateralMotion(shorter, config.reference_step, now.inverse_mass, fading);
  }
};

template struct KinematicsContract<EdgeEdgeKinematics>;

} // namespace brickwall::contact
