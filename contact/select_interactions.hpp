// Which faces each node is in contact with, and the state of those contacts: the selection, birth, switch and
// stiffness rules of shared/physics.md, section 4, and steps 1 to 3 of shared/contact_energy.md. Kernel functor.
#pragma once

#include "contact/face_access.hpp"
#include "contact/penalty.hpp"

namespace brickwall::contact {

// One thread per row of candidates, which is one per surface node: projects the node onto its candidates, chooses one face of
// each opposing body and writes the node's row of `next`. Rows of candidates are in the order of (body, face id), so ties go
// to the lower id.
struct SelectInteractions {
  using value_type = ContactSums;

  EnforcementConfig config;
  LimbScale energy_scale;
  double dt, previous_dt;
  FaceAccess faces;
  CandidatePairs pairs;
  NodeFaceLists around;
  View<const MeanPlane*> planes; // own, remote, ghost faces
  int num_remote;
  View<const double*> node_mass;
  ContactHistory previous;
  ContactHistory next; // interactions beyond its extent are counted, not written
  View<std::int64_t> next_count;
  View<unsigned char*> status;
  View<double*> gap;

  // A face that the node penetrates. No default values: arrays of it are not initialised.
  struct Hit {
    double weight[4];
    double normal[3];
    double depth; // P
    int face; // candidate index
    int previous; // interaction with the same body at the last step, or -1
    int previous_face; // candidate index of that interaction's face, or -1

    KOKKOS_INLINE_FUNCTION void set(int face_index, const FacePoint& point) {
      for (int j = 0; j < 4; ++j)
        weight[j] = point.weight[j];
      for (int d = 0; d < 3; ++d)
        normal[d] = point.normal[d];
      depth = -point.gap;
      face = face_index;
    }
    KOKKOS_INLINE_FUNCTION Vec3 unitNormal() const { return {normal[0], normal[1], normal[2]}; }
  };

  // Part of the node's surface that opposes a face: A_i, its mean surface mass, both zero if there is none.
  struct Tributary {
    double area = 0; // length^2
    double surface_mass = 0; // mass/area
  };

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t row, ContactSums& sums) const {
    const int node = pairs.node(row);
    Hit hits[max_interactions];
    int seen = 0; // bit s: the face of the node's previous interaction s is still a candidate
    const int num_hits = findHits(row, node, hits, seen, sums);
    countLost(node, seen, sums);
    status(node) = static_cast<unsigned char>(num_hits);
    next.row_count(node) = static_cast<unsigned char>(num_hits);
    double least_gap = 0;
    if (num_hits > 0) {
      const std::int64_t begin =
          Kokkos::atomic_fetch_add(next_count.data(), static_cast<std::int64_t>(num_hits));
      next.row_begin(node) = static_cast<int>(begin);
      for (int h = 0; h < num_hits; ++h) {
        const Interaction interaction = interact(node, hits, num_hits, h);
        least_gap = minOf(least_gap, -hits[h].depth);
        addTo(sums, interaction, hits[h]);
        if (begin + h < static_cast<std::int64_t>(next.interactions.extent(0)))
          next.interactions(begin + h) = interaction;
      }
    }
    gap(node) = least_gap;
  }

  // One hit per opposing body. Returns their number.
  KOKKOS_INLINE_FUNCTION int findHits(std::int64_t row, int node, Hit (&hits)[max_interactions],
                                      int& seen, ContactSums& sums) const {
    const std::int64_t end = pairs.end(row);
    const global_id own_body = faces.surface.node_body(node);
    int num_hits = 0;
    for (std::int64_t pair = pairs.begin(row); pair < end;) {
      const global_id body = faces.body(pairs.faces(pair));
      Hit hit;
      const bool wanted = body != own_body || config.self_contact;
      const bool found = findHitOnBody(node, body, wanted, end, pair, hit, seen);
      if (!found)
        continue;
      if (num_hits < max_interactions)
        hits[num_hits++] = hit;
      else
        ++sums.overflow;
    }
    return num_hits;
  }

  // The face of `body` that the node is in contact with: the last one if it still is, else the least penetrated.
  // Moves `pair` past the body's candidates.
  KOKKOS_INLINE_FUNCTION bool findHitOnBody(int node, global_id body, bool wanted, std::int64_t end,
                                            std::int64_t& pair, Hit& hit, int& seen) const {
    const std::int64_t begin = pair;
    findPreviousFace(node, body, end, pair, hit, seen);
    if (!wanted)
      return false;
    const Vec3 x = rowOf(faces.surface.coordinates_new, node);
    FacePoint point;
    if (hit.previous_face >= 0 && touches(node, x, hit.previous_face, point)) {
      hit.set(hit.previous_face, point);
      return true;
    }
    bool found = false;
    for (std::int64_t p = begin; p < pair; ++p) {
      const int face = pairs.faces(p);
      if (face == hit.previous_face || !touches(node, x, face, point))
        continue;
      if (!found || -point.gap < hit.depth)
        hit.set(face, point);
      found = true;
    }
    return found;
  }

  // What the node touched on `body` at the last step, if that face is among the body's candidates. Moves `pair` past
  // them.
  KOKKOS_INLINE_FUNCTION void findPreviousFace(int node, global_id body, std::int64_t end,
                                               std::int64_t& pair, Hit& hit, int& seen) const {
    const int slot = previousSlot(node, body);
    hit.previous = slot < 0 ? -1 : previous.row_begin(node) + slot;
    hit.previous_face = -1;
    const global_id last_face = slot < 0 ? -1 : previous.interactions(hit.previous).face;
    for (; pair < end; ++pair) {
      const int face = pairs.faces(pair);
      if (faces.body(face) != body)
        return;
      if (slot >= 0 && faces.id(face) == last_face && isOfThisStep(node, face)) {
        seen |= 1 << slot;
        hit.previous_face = face;
      }
    }
  }

  // Whether the node is inside the face, by the cheap tests first.
  KOKKOS_INLINE_FUNCTION bool touches(int node, const Vec3& x, int face, FacePoint& point) const {
    const MeanPlane& plane = planes(planeOf(face));
    if (plane.surelyOutside(x, config.lateral_tolerance) || !isOpposed(node, plane.normal))
      return false;
    point = project(faces.quad(face), x);
    return point.activeWithin(config.lateral_tolerance) && point.gap < 0 &&
           isOfThisStep(node, face);
  }
  // Whether a search in this step would list the pair. Asked last and so of few pairs: with it the contacts do not depend
  // on the margin.
  KOKKOS_INLINE_FUNCTION bool isOfThisStep(int node, int face) const {
    const StepTest& test = pairs.step_test;
    return !test.is_needed ||
           faces.boxesOverlap(node, face, test.node_tolerance, test.face_tolerance);
  }

  KOKKOS_INLINE_FUNCTION int planeOf(int face) const {
    return faces.isOwn(face) ? face : face + num_remote;
  }
  KOKKOS_INLINE_FUNCTION int previousSlot(int node, global_id body) const {
    for (int s = 0; s < previous.row_count(node); ++s)
      if (previous.interactions(previous.row_begin(node) + s).body == body)
        return s;
    return -1;
  }
  KOKKOS_INLINE_FUNCTION bool opposes(const MeanPlane& plane, const Vec3& normal) const {
    return dot(plane.normal, normal) < -config.opposed_cosine;
  }
  KOKKOS_INLINE_FUNCTION bool isOpposed(int node, const Vec3& normal) const {
    for (int k = around.offsets(node); k < around.offsets(node + 1); ++k)
      if (opposes(planes(around.rows(k)), normal))
        return true;
    return false;
  }
  KOKKOS_INLINE_FUNCTION Tributary tributary(int node, const Vec3& normal) const {
    Tributary part;
    for (int k = around.offsets(node); k < around.offsets(node + 1); ++k) {
      const int row = around.rows(k);
      if (!opposes(planes(row), normal))
        continue;
      const double area = around.corner_share(row) * planes(row).area;
      part.area += area;
      part.surface_mass += around.surface_mass(row) * area;
    }
    if (part.area > 0)
      part.surface_mass /= part.area;
    return part;
  }

  // k = min(eps A_i, s m_red/dt_ref^2), A_i shared by the node's interactions of one normal direction.
  KOKKOS_INLINE_FUNCTION double stiffnessCap(int node, const Hit (&hits)[max_interactions],
                                             int num_hits, int h, double inverse_mass) const {
    const Hit& hit = hits[h];
    int sharing = 0;
    for (int other = 0; other < num_hits; ++other)
      if (other == h || dot(hits[other].unitNormal(), hit.unitNormal()) > config.shared_cosine)
        ++sharing;
    const Tributary part = tributary(node, planes(planeOf(hit.face)).normal);
    const double face_mass = faces.attribute(hit.face, NodeFaces::surface_mass_column);
    const double scale = config.penalty / (config.reference_step * config.reference_step);
    // eps A_i / scale
    const double by_area = part.area / sharing / (1.0 / part.surface_mass + 1.0 / face_mass);
    return scale * (by_area * inverse_mass < 1 ? by_area : 1.0 / inverse_mass);
  }

  // 1/m_s + sum N_j^2/m_j
  KOKKOS_INLINE_FUNCTION double inverseReducedMass(int node, const Hit& hit) const {
    double sum = 1.0 / node_mass(node);
    for (int j = 0; j < 4; ++j)
      sum += hit.weight[j] * hit.weight[j] / faces.attribute(hit.face, j);
    return sum;
  }

  KOKKOS_INLINE_FUNCTION Interaction interact(int node, const Hit (&hits)[max_interactions],
                                              int num_hits, int h) const {
    const Hit& hit = hits[h];
    Interaction now;
    now.body = faces.body(hit.face);
    now.face = faces.id(hit.face);
    now.node = node;
    now.face_index = hit.face;
    now.normal = hit.unitNormal();
    for (int j = 0; j < 4; ++j)
      now.weight[j] = hit.weight[j];
    now.closing = faces.closing(node, hit.face, now.normal, now.weight);
    const double inverse_mass = inverseReducedMass(node, hit);
    now.mobility = dt * dt * inverse_mass;
    const double cap = stiffnessCap(node, hits, num_hits, h, inverse_mass);
    if (hit.previous < 0)
      bear(now, hit.depth, cap);
    else
      carryOn(now, previous.interactions(hit.previous), hit, cap);
    now.depth = hit.depth - now.offset;
    now.first_force = now.stiffness * now.depth;
    now.force = now.first_force;
    return now;
  }

  // What the motion of this step did not bring is taken as an offset: no energy comes from nowhere, and an initial
  // overlap, which is a birth at rest, gives no force.
  KOKKOS_INLINE_FUNCTION static void bear(Interaction& now, double depth, double cap) {
    now.stiffness = cap;
    now.offset = depth - minOf(depth, maxOf(0.0, now.closing));
  }

  KOKKOS_INLINE_FUNCTION void carryOn(Interaction& now, const Interaction& last, const Hit& hit,
                                      double cap) const {
    now.is_new = last.depth <= 0;
    now.stored = last.stored + workOnContact(now.node, last, hit.previous_face);
    now.offset =
        last.face == now.face ? minOf(last.offset, hit.depth) : maxOf(0.0, hit.depth - last.depth);
    now.stiffness = now.is_new ? cap : last.stiffness;
    if (cap < now.stiffness) { // softer at equal stored energy
      const double depth = hit.depth - now.offset;
      now.offset = hit.depth - minOf(hit.depth, depth * std::sqrt(now.stiffness / cap));
      now.stiffness = cap;
    }
  }

  // -dt F n . (v^{n-1/2} + v^{n+1/2})/2 of the last force, whose second half step is the motion of this one.
  KOKKOS_INLINE_FUNCTION double workOnContact(int node, const Interaction& last,
                                              int last_face) const {
    if (last_face < 0)
      return 0;
    const double closing = faces.closing(node, last_face, last.normal, last.weight);
    return 0.25 * last.force * (last.closing / previous_dt + closing / dt) * (previous_dt + dt);
  }

  KOKKOS_INLINE_FUNCTION void addTo(ContactSums& sums, const Interaction& now,
                                    const Hit& hit) const {
    ++sums.interactions;
    sums.active += now.depth > 0;
    const double area = planes(planeOf(hit.face)).area;
    sums.max_penetration = maxOf(sums.max_penetration, hit.depth / std::sqrt(area));
    if (hit.previous < 0)
      return;
    const Interaction& last = previous.interactions(hit.previous);
    const double stiffness = std::sqrt(last.stiffness * now.stiffness);
    sums.stored.add(0, 0.5 * stiffness * last.depth * now.depth, energy_scale);
  }

  // A loaded contact cannot leave the candidates (boxes hold x^n and x^{n+1}) unless it is deeper than their tolerance.
  KOKKOS_INLINE_FUNCTION void countLost(int node, int seen, ContactSums& sums) const {
    for (int s = 0; s < previous.row_count(node); ++s)
      if (!(seen & (1 << s)) && previous.interactions(previous.row_begin(node) + s).depth > 0)
        ++sums.lost;
  }
};

} // namespace brickwall::contact
