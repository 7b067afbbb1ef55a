// Contact of convex edges with convex edges that they cross: nodes and faces feel each other only when a node is inside, which
// for edges that cross in mid-cell is half a cell too late. Kernel functor parts for SelectInteractions.
//
// An "edge" is stored as a quad: corners 0 and 1 are its ends, and all four are the face of its body that lists it, so that
// its outward normals follow the body: n_1 is the face's, n_2 = cos n_1 + sin (t x n_1), t from corner 0 to corner 1.
#pragma once

#include "contact/enforcement/edge_edge/edge_activation.hpp"
#include "contact/enforcement/law/edge_fading.hpp"
#include "contact/enforcement/law/persistent_contact.hpp"
#include "contact/enforcement/selection/select_interactions.hpp"

namespace brickwall::contact {

// The directions that stick out of an edge: between the normals of its two faces.
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
  // How far a unit vector across the edge lies inside the cone: the lesser sine of its angles to both normals (1 beyond a right
  // angle); negative outside.
  KOKKOS_INLINE_FUNCTION double depthOf(const Vec3& n) const {
    if (dot(n, first + second) <= 0) // to the inside of the body
      return -1;
    const double from_first = dot(cross(first, n), tangent);
    const double to_second = dot(cross(n, second), tangent);
    return minOf(dot(n, first) > 0 || from_first < 0 ? from_first : 1,
                 dot(n, second) > 0 || to_second < 0 ? to_second : 1);
  }
};

// Where the lines of two edges come closest: at shares s and t from a + s da and b + t db, between = a - b.
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

struct EdgeEdgeKinematics {
  static constexpr bool books_spring_work = true;
  static constexpr bool knows_motion = false; // look() works out last_motion alone
  static constexpr bool tests_rows_together = true; // by rowsThatMayActivate()
  // Edges of smaller sines, between each other or to a face, are left to nodes and faces: a node half a cell away is then inside
  // before the depth is a twentieth of a cell.
  static constexpr double least_sine = 0.05;
  static constexpr double parallel_sine = 0.2; // below it a contact may come to be held
  // But where an edge spans a side of the other's body, it has no node over it that could be inside: bars narrower than their
  // elements would pass through each other. It ends beyond the side by so many lateral tolerances of half its width; nodes that
  // are nearer are in contact with the side.
  static constexpr double beyond_side = 0.8;
  // Of the shorter edge: crossed no deeper than that, they may begin. Edges of bricks that lie flat on each other cross at no
  // depth and at no angle; when they have turned by `least_sine`, nodes half a cell away have let them in by half of that.
  static constexpr double shallow = 0.06;
  static constexpr double overhang =
      0.5; // of an edge's length: how far it pushes on over the next one
  static constexpr double full_outside =
      0.5; // a contact that has begun ends when it is this far outside
  static constexpr double stiffness_share = 0.5; // of a node's: edges act beside nodes
  // Of the shorter edge: what is deeper when it is found did not come through these edges; no contact goes on deeper.
  static constexpr double deepest_birth = 0.5, deepest = 1;

  double lateral_tolerance, edge_tolerance;
  int num_corners; // rows below it are ends of edges, row num_corners + e is edge e
  View<const double*> node_mass; // [corner]
  View<const Interaction*> previous;
  EdgeRecords records;

  // Each pair of edges once: the one of the lower body pushes.
  KOKKOS_INLINE_FUNCTION bool pushes(global_id own_body, global_id body) const {
    return own_body <= body;
  }
  KOKKOS_INLINE_FUNCTION int edgeOf(int node) const { return node - num_corners; }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchFace(int edge) const { prefetch(&records.of(edge)); }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchHead(int node) const {
    prefetch(&records.of(edgeOf(node)));
  }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchNode(int) const {}
  KOKKOS_INLINE_FUNCTION global_id bodyOf(const FaceAccess&, int edge) const {
    return records.of(edge).body;
  }
  KOKKOS_INLINE_FUNCTION global_id idOf(const FaceAccess&, int edge) const {
    return records.of(edge).id;
  }

  // The edges at x^{n+1} from their first ends, and the way from the first end of `other` to that of `own`.
  KOKKOS_INLINE_FUNCTION static void lines(const FaceAccess& faces, int own, int other, Vec3& da,
                                           Vec3& db, Vec3& between) {
    const auto& nodes = faces.surface.coordinates_new;
    const auto& ghosts = faces.ghosts.coordinates_new;
    const Vec3 a = faces.corner(own, 0, nodes, ghosts), b = faces.corner(other, 0, nodes, ghosts);
    da = faces.corner(own, 1, nodes, ghosts) - a;
    db = faces.corner(other, 1, nodes, ghosts) - b;
    between = a - b;
  }

  // Bit r: row rows[r] of edge e holds an edge that e may come to touch: 0 only if test() at ContactTest::activate is false for all that it is
  // to push. Of the rows of the bits in `wanted`. Rows are in the order of bodies, those that e does not push come first.
  KOKKOS_INLINE_FUNCTION unsigned rowsThatMayActivate(const FaceAccess& faces,
                                                      const CandidatePairs& pairs,
                                                      const std::int64_t* rows, int count,
                                                      unsigned wanted) const {
    const EdgeBirthLimits limits{least_sine, 0.5 * lateral_tolerance, deepest_birth,
                                 1 + 2 * beyondSide()};
    EdgeBirths<Lanes> births{faces, records, limits, 0, {}, {}};
    for (int r = 0; r < count; ++r) {
      if (!(wanted >> r & 1u))
        continue;
      const int own = edgeOf(pairs.node(rows[r]));
      const global_id body = records.of(own).body;
      const std::int64_t begin = pairs.begin(rows[r]);
      for (std::int64_t p = pairs.end(rows[r]); p-- > begin;) {
        const int other = pairs.faces(p);
        if (!pushes(body, records.of(other).body))
          break;
        births.add(r, own, other);
      }
    }
    births.finish();
    return births.rows;
  }
  // A loaded contact is looked at by test().
  KOKKOS_INLINE_FUNCTION void look(const FaceAccess& faces, const ContactHistory& history,
                                   int count, PersistentContact* contacts) const {
    for (int k = 0; k < count; ++k) {
      const Interaction& last = history.interactions(contacts[k].previous);
      contacts[k].last_motion = faces.relativeMotion(last.point, contacts[k].face, last.weight);
    }
  }
  KOKKOS_INLINE_FUNCTION bool testAgain(const FaceAccess& faces, const PersistentContact& known,
                                        FaceContact& hit) const {
    return test(faces, known.node, known.face, ContactTest::persist, hit);
  }

  KOKKOS_INLINE_FUNCTION bool test(const FaceAccess& faces, int node, int other,
                                   ContactTest test_kind, FaceContact& hit) const {
    const int own = edgeOf(node);
    Vec3 da, db, between;
    lines(faces, own, other, da, db, between);
    const Crossing crossing(da, db, between);
    const bool is_held = test_kind == ContactTest::retain;
    hit.is_held = is_held && (previous(hit.previous).is_held || !crossing.isAcross(parallel_sine));
    if (hit.is_held)
      return isHeld(da, db, between, previous(hit.previous), other, hit);
    const bool is_kept = test_kind == ContactTest::persist || is_held;
    const double aa = crossing.aa, bb = crossing.bb;
    // A contact that is held goes on where the edges cross when they are open again.
    if (is_kept && previous(hit.previous).is_held && !crossing.isAcross(parallel_sine))
      return false;
    if (!crossing.isAcross(least_sine) ||
        crossing.isFarBeyond(start() + 0.5)) // more than isOn() takes
      return false;
    const double s = crossing.s, t = crossing.t;
    const Vec3 across = cross(da, db);
    Vec3 normal = (1 / norm(across)) * across;
    double depth = -dot(between, normal);
    const double limit = hit.previous < 0 ? deepest_birth : deepest;
    if (!(depth * depth < limit * limit * minOf(aa, bb)))
      return false;
    const EdgeCone cone_b(faces.quad(other), faces.attributes<EdgeAttributes>(other));
    if (dot(normal, cone_b.first + cone_b.second) < 0) {
      normal = -normal;
      depth = -depth;
    }
    if (!(depth > 0) ||
        !isOn(goesOn(faces, own), s, depth, std::sqrt(aa), hit.previous >= 0, overhang) ||
        !isOn(goesOn(faces, other), t, depth, std::sqrt(bb), is_kept,
              is_held ? overhang : lateral_tolerance))
      return false;
    const EdgeCone cone_a(faces.quad(own), faces.attributes<EdgeAttributes>(own));
    const double in_a = cone_a.depthOf(-normal), in_b = cone_b.depthOf(normal);
    const bool leads_out =
        is_kept ? minOf(in_a, in_b) > -full_outside
                : (in_a > least_sine || isSpanned(faces, own, cone_a, -normal, in_a, t, db)) &&
                      (in_b > least_sine || isSpanned(faces, other, cone_b, normal, in_b, s, da));
    if (!leads_out || sharesNode(faces, own, other))
      return false;
    if (hit.previous < 0 && depth * depth > shallow * shallow * minOf(aa, bb) &&
        !wereApart(faces, own, other, normal))
      return false;
    setHit(s, t, normal, depth, other, hit);
    return true;
  }
  // In widths of a side.
  KOKKOS_INLINE_FUNCTION double beyondSide() const { return 0.5 * beyond_side * lateral_tolerance; }
  // Whether the direction n, on the rim of the edge's cone, sticks out of a side that the other edge spans: that crosses here, at
  // share `at` of its way.
  KOKKOS_INLINE_FUNCTION bool isSpanned(const FaceAccess& faces, int edge, const EdgeCone& cone,
                                        const Vec3& n, double inside, double at,
                                        const Vec3& other_way) const {
    if (!(inside > -least_sine))
      return false;
    const bool of_first = dot(n, cone.first) > dot(n, cone.second);
    const Vec3 inward =
        of_first ? cross(cone.first, cone.tangent) : cross(cone.tangent, cone.second);
    const double width = faces.attributes<EdgeAttributes>(edge).width[of_first ? 0 : 1];
    const double along = dot(other_way, inward);
    const double one_end = -at * along, other_end = (1 - at) * along;
    return minOf(one_end, other_end) < -beyondSide() * width &&
           maxOf(one_end, other_end) > (1 + beyondSide()) * width;
  }
  KOKKOS_INLINE_FUNCTION static void setHit(double s, double t, const Vec3& normal, double depth,
                                            int other, FaceContact& hit) {
    hit.weight[0] = 1 - t, hit.weight[1] = t;
    hit.weight[2] = hit.weight[3] = 0;
    for (int d = 0; d < 3; ++d)
      hit.normal[d] = normal[d];
    hit.place[0] = s;
    hit.depth = depth;
    hit.face = other;
  }
  // Under load edges may turn parallel, and the place where they cross runs away. The contact then holds between the two points where
  // it was last, along the way from one to the other (no couple, and the force of an energy), until that way has gone or
  // turned round.
  KOKKOS_INLINE_FUNCTION static bool isHeld(const Vec3& da, const Vec3& db, const Vec3& between,
                                            const Interaction& last, int other, FaceContact& hit) {
    const double s = last.point.share, t = last.weight[1];
    const Vec3 way = (t * db - s * da) - between;
    const double square = dot(way, way);
    if (!(dot(way, last.normal) > 0 &&
          square < deepest * deepest * minOf(dot(da, da), dot(db, db))))
      return false;
    const double depth = std::sqrt(square);
    setHit(s, t, (1 / depth) * way, depth, other, hit);
    return true;
  }

  // Beyond the end of a brick's edge a contact that has begun fades out, as beyond the edges of faces: from `start` on over `way`,
  // in shares of the edge's length.
  static constexpr double depths_to_end = 3;
  KOKKOS_INLINE_FUNCTION double start() const { return 0.1 * edge_tolerance; }
  KOKKOS_INLINE_FUNCTION double fadeLength(double depth, double length) const {
    return minOf(maxOf(0.4 * edge_tolerance, depths_to_end * depth / length), 0.5);
  }
  // Whether a point at share `s` of the edge is on it: exactly where another edge goes on, else with a tolerance. A contact that
  // has begun goes on a little over the next edge, since pressed edges are bent; the pushing one over half of it, so that a
  // short slide does not end the contact.
  KOKKOS_INLINE_FUNCTION bool isOn(int goes_on, double s, double depth, double length,
                                   bool has_begun, double past_inner) const {
    const double at_end = has_begun ? start() + fadeLength(depth, length) : 0.5 * lateral_tolerance;
    const double over = has_begun ? past_inner : 0;
    return s >= -(goes_on & 1 ? over : at_end) && s <= 1 + (goes_on & 2 ? over : at_end);
  }
  KOKKOS_INLINE_FUNCTION static int goesOn(const FaceAccess& faces, int edge) {
    return static_cast<int>(faces.attributes<EdgeAttributes>(edge).goes_on);
  }
  KOKKOS_INLINE_FUNCTION FadeWeight endTaper(int goes_on, double s, double depth,
                                             double length) const {
    FadeWeight fade_weight;
    const bool at_second = s > 0.5;
    const double beyond = (at_second ? s - 1 : -s) - start();
    if (beyond <= 0 || (goes_on & (at_second ? 2 : 1)))
      return fade_weight;
    const double all = fadeLength(depth, length), t = maxOf(1 - beyond / all, 0.0);
    const double steepness = 6 * t * (1 - t) / all;
    fade_weight.value = t * t * (3 - 2 * t);
    fade_weight.slope = at_second ? -steepness : steepness;
    fade_weight.remaining = t * all;
    if (all > 0.4 * edge_tolerance && all < 0.5)
      fade_weight.growth = steepness * beyond / all * depths_to_end / length;
    return fade_weight;
  }

  // Contacts begin when edges come to cross, not when edges that have crossed come to lie side by side: whether they had not
  // crossed at x^n, where their common normal pointed to the same side as `normal`.
  KOKKOS_INLINE_FUNCTION bool wereApart(const FaceAccess& faces, int own, int other,
                                        const Vec3& normal) const {
    const auto& nodes = faces.surface.coordinates_old;
    const auto& ghosts = faces.ghosts.coordinates_old;
    const Vec3 a = faces.corner(own, 0, nodes, ghosts), b = faces.corner(other, 0, nodes, ghosts);
    Vec3 old_normal =
        cross(faces.corner(own, 1, nodes, ghosts) - a, faces.corner(other, 1, nodes, ghosts) - b);
    if (dot(old_normal, normal) < 0)
      old_normal = -old_normal;
    return dot(a - b, old_normal) >= 0;
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

  // Edges slide on over bends (isOn()), and end their contacts before they are apart again.
  KOKKOS_INLINE_FUNCTION bool isPastInner(const FaceAccess&, const FaceContact&) const {
    return false;
  }
  KOKKOS_INLINE_FUNCTION bool isOutside(const FaceAccess&, int, int) const { return false; }
  KOKKOS_INLINE_FUNCTION void setLevers(const FaceAccess& faces, const Interaction& now, double P,
                                        Vec3 (&lever)[2]) const {
    const Quad one = faces.quad(edgeOf(now.node)), other = faces.quad(now.face_index);
    dualBasis(one.corner[1] - one.corner[0], other.corner[1] - other.corner[0], P, lever);
  }
  // Of the motion along the normal, by the share of each edge's second end.
  KOKKOS_INLINE_FUNCTION void slopesOfMotion(const FaceAccess& faces, const Interaction& pair,
                                             int face, double (&slope)[2]) const {
    slope[0] = dot(pair.normal,
                   faces.nodeMotion(pair.point.node[1]) - faces.nodeMotion(pair.point.node[0]));
    slope[1] = dot(pair.normal, faces.cornerMotion(face, 1) - faces.cornerMotion(face, 0));
  }

  KOKKOS_INLINE_FUNCTION ContactPoint pointOf(const FaceAccess& faces, int node,
                                              const FaceContact& hit) const {
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
  KOKKOS_INLINE_FUNCTION double relativeDepth(const FaceAccess& faces,
                                              const FaceContact& hit) const {
    const Quad quad = faces.quad(hit.face);
    return hit.depth / norm(quad.corner[1] - quad.corner[0]);
  }
  KOKKOS_INLINE_FUNCTION void record(int, int, double) const {}

  KOKKOS_INLINE_FUNCTION double stiffnessCap(const EnforcementConfig& config,
                                             const Interaction& now) const {
    if (!(now.inverse_mass > 0)) // all held
      return 0;
    return stiffness_share * config.penalty /
           (config.reference_step * config.reference_step * now.inverse_mass);
  }
  KOKKOS_INLINE_FUNCTION double stiffnessAtBirth(const EnforcementConfig& config, const FaceAccess&,
                                                 const Interaction& now,
                                                 const FaceContact (&)[max_interactions], int,
                                                 int) const {
    return stiffnessCap(config, now);
  }

  // U = k w(s) w(t) p^2/2, s and t where the two lines are closest: r = x_own(s) - x_other(t) is perpendicular to both, so that
  // a ds - b dt = -(D . d_own + r . delta d_own), b ds - c dt = -(D . d_other + r . delta d_other), with D the motion of the one
  // point from the other, a, b, c the products of d_own and d_other.
  KOKKOS_INLINE_FUNCTION double fadeWeightOf(const FaceAccess& faces, int node,
                                             const FaceContact& hit) const {
    const int own = edgeOf(node);
    const Quad one = faces.quad(own), other = faces.quad(hit.face);
    return endTaper(goesOn(faces, own), hit.place[0], hit.depth,
                    norm(one.corner[1] - one.corner[0]))
               .value *
           endTaper(goesOn(faces, hit.face), hit.weight[1], hit.depth,
                    norm(other.corner[1] - other.corner[0]))
               .value;
  }
  KOKKOS_INLINE_FUNCTION void fade(const EnforcementConfig& config, const FaceAccess& faces,
                                   const FaceContact& hit, Interaction& now,
                                   FadingForce& fading) const {
    const int own = edgeOf(now.node);
    const double s = hit.place[0], t = hit.weight[1];
    now.fade_weight = 1;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1)
      return;
    const Quad one = faces.quad(own), other = faces.quad(hit.face);
    const Vec3 da = one.corner[1] - one.corner[0], db = other.corner[1] - other.corner[0];
    const double a = dot(da, da), b = dot(da, db), c = dot(db, db);
    const double length_a = std::sqrt(a), length_b = std::sqrt(c);
    const FadeWeight at_s = endTaper(goesOn(faces, own), s, hit.depth, length_a);
    const FadeWeight at_t = endTaper(goesOn(faces, hit.face), t, hit.depth, length_b);
    const double p = maxOf(now.depth, 0.0), energy = 0.5 * now.stiffness * p * p;
    now.fade_weight = at_s.value * at_t.value;
    now.first_force +=
        now.stiffness * now.depth *
        (now.fade_weight - 1 + 0.5 * p * (at_s.growth * at_t.value + at_s.value * at_t.growth));
    const double g_s = energy * at_s.slope * at_t.value, g_t = energy * at_s.value * at_t.slope;
    const double determinant = maxOf(a * c - b * b, least_sine * least_sine * a * c);
    const double q_own = (g_s * c + g_t * b) / determinant;
    const double q_other = -(g_s * b + g_t * a) / determinant;
    fading.on_node = q_own * da + q_other * db;
    fading.work_to_end =
        energy * minOf(at_s.changeToZero() * at_t.value, at_t.changeToZero() * at_s.value);
    fading.normal.on_end = -q_own * hit.depth; // r = -P n
    fading.normal.on_corner[0] = q_other * hit.depth;
    fading.normal.on_corner[1] = -fading.normal.on_corner[0];
    const double shorter = minOf(fadeLength(hit.depth, length_a) * length_a,
                                 fadeLength(hit.depth, length_b) * length_b);
    keepWithin(shorter, config.reference_step, now.inverse_mass, fading);
  }
};

} // namespace brickwall::contact
