// Which faces each node (or edge) is in contact with, and the state of those contacts: one face of each opposing body, kept
// while it lasts; birth, switch, stiffness and friction as penalty.hpp states them. Kernel functor.
//
// `Touch` knows the geometry: NodeFaceTouch or EdgeTouch.
#pragma once

#include "contact/contact_sums.hpp"
#include "contact/coulomb_friction.hpp"
#include "contact/enforcement_config.hpp"
#include "contact/face_access.hpp"

namespace brickwall::contact {

// A face that a node or an edge penetrates. No default values: arrays of it are not initialised.
struct Hit {
  double weight[4];
  double normal[3];
  double place[2]; // of a node: xi, eta on the face; of an edge: share of its second node
  double depth; // P
  Vec3 motion; // of the node in this step as seen from the face point
  double contact_work; // energy that the last force put into the contact with the same body
  int face; // candidate index
  int previous; // interaction with the same body at the last step, or -1
  int previous_face; // candidate index of that interaction's face, or -1
  bool is_held; // Stage::held: until it has no load, or its edges cross again
  bool is_loaded;
  bool has_ended; // that interaction: its node is outside the face again

  KOKKOS_INLINE_FUNCTION Vec3 unitNormal() const { return {normal[0], normal[1], normal[2]}; }
};

// What a face is tested for: to keep a contact, to bear one (or to go on with it there as if it were born), or, if no face is
// fit for that, to go on with a contact under load where the surfaces are turned towards each other no more than a little; or, if
// there is none, to hold on to the last one: between faces or edges that are bent away from each other is a wedge that neither
// covers.
enum class Stage { kept, born, switched, held };

// One thread per row of candidates, which is one per surface node: tests the node against its candidates, chooses one face of
// each opposing body and writes the node's row of `next`. Rows of candidates are in the order of (body, face id), so ties go
// to the lower id.
template <class Touch>
struct SelectInteractions {
  using value_type = ContactSums;

  static constexpr double least_taper = 0.01; // below it a switch does not keep the energy

  EnforcementConfig config;
  LimbScale energy_scale;
  double dt, previous_dt;
  Touch touch;
  FaceAccess faces = {{}, GhostFaces::none()};
  CandidatePairs pairs = CandidatePairs::none();
  ContactHistory previous;
  ContactHistory next; // interactions beyond its extent are counted, not written
  View<std::int64_t> next_count;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t row, ContactSums& sums) const {
    const int node = pairs.node(row);
    Hit hits[max_interactions];
    int seen = 0; // bit s: the face of the node's previous interaction s is still a candidate
    const int num_hits = findHits(row, node, hits, seen, sums);
    countLost(node, seen, sums);
    double deepest = 0;
    int num_loaded = 0;
    for (int h = 0; h < num_hits; ++h) {
      deepest = maxOf(deepest, hits[h].depth);
      hits[h].is_loaded = bearsLoad(node, hits[h]);
      num_loaded += hits[h].is_loaded;
    }
    touch.record(node, num_hits, deepest);
    sums.touching += num_hits;
    next.row_count(node) = static_cast<unsigned char>(num_loaded);
    if (num_loaded == 0)
      return;
    std::int64_t index =
        Kokkos::atomic_fetch_add(next_count.data(), static_cast<std::int64_t>(num_loaded));
    next.row_begin(node) = static_cast<int>(index);
    for (int h = 0; h < num_hits; ++h) {
      if (!hits[h].is_loaded)
        continue;
      const bool has_room = index < static_cast<std::int64_t>(next.interactions.extent(0));
      interact(node, hits, num_hits, h, has_room ? index : -1, sums);
      ++index;
    }
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
      const bool wanted = (body != own_body || config.self_contact) && touch.pushes(own_body, body);
      const bool found = findHitOnBody(node, body, wanted, end, pair, hit, seen, sums);
      if (!found)
        continue;
      if (num_hits < max_interactions)
        hits[num_hits++] = hit;
      else
        ++sums.overflow;
    }
    return num_hits;
  }

  // The face of `body` that the node is in contact with: the last one if it still is under load, else the least penetrated.
  // Moves `pair` past the body's candidates.
  KOKKOS_INLINE_FUNCTION bool findHitOnBody(int node, global_id body, bool wanted, std::int64_t end,
                                            std::int64_t& pair, Hit& hit, int& seen,
                                            ContactSums& sums) const {
    const std::int64_t begin = pair;
    findPreviousFace(node, body, end, pair, hit, seen, sums);
    if (!wanted)
      return false;
    // A contact without load is chosen anew: else a node that slid in beside a face would stay with it for ever.
    const bool is_loaded = hit.previous >= 0 && previous.interactions(hit.previous).depth > 0;
    const bool has_face = is_loaded && hit.previous_face >= 0;
    if (has_face && isTouching(node, hit.previous_face, Stage::kept, hit))
      return true;
    // Where it went out through the face, the contact has ended and given back its energy; what it touches now, it meets anew.
    hit.has_ended = has_face && touch.isOutside(faces, node, hit.previous_face);
    if (findNearest(node, begin, pair, Stage::born, is_loaded, hit))
      return true;
    if (!is_loaded || hit.has_ended)
      return false;
    return findNearest(node, begin, pair, Stage::switched, is_loaded, hit) ||
           (has_face && isTouching(node, hit.previous_face, Stage::held, hit));
  }

  // Whether the contact has a force, for all that is known yet. One without is forgotten: the next step chooses its face anew, and
  // takes the penetration that it finds as the offset.
  KOKKOS_INLINE_FUNCTION bool bearsLoad(int node, Hit& hit) const {
    hit.motion = faces.relativeMotion(touch.pointOf(faces, node, hit), hit.face, hit.weight);
    if (!goesOn(hit))
      return dot(hit.unitNormal(), hit.motion) < 0;
    const Interaction& last = previous.interactions(hit.previous);
    return last.face != faces.id(hit.face) || last.is_held != hit.is_held ||
           hit.depth > last.offset;
  }

  // The least penetrated of the candidates [begin, end), but for a previous face that the node has left.
  KOKKOS_INLINE_FUNCTION bool findNearest(int node, std::int64_t begin, std::int64_t end,
                                          Stage stage, bool has_left, Hit& hit) const {
    bool found = false;
    Hit nearest, other;
    for (std::int64_t p = begin; p < end; ++p) {
      const int face = pairs.faces(p);
      other.previous = has_left || face == hit.previous_face ? hit.previous : -1;
      if ((has_left && face == hit.previous_face) || !isTouching(node, face, stage, other) ||
          !hasComeThrough(node, other))
        continue;
      if (!found || other.depth < nearest.depth)
        nearest = other;
      found = true;
    }
    if (!found)
      return false;
    nearest.previous = hit.previous;
    nearest.previous_face = hit.previous_face;
    nearest.contact_work = hit.contact_work;
    nearest.has_ended = hit.has_ended;
    hit = nearest;
    return true;
  }

  // What the node touched on `body` at the last step, if that face is among the body's candidates, and the work that its
  // forces did since. Moves `pair` past the body's candidates.
  KOKKOS_INLINE_FUNCTION void findPreviousFace(int node, global_id body, std::int64_t end,
                                               std::int64_t& pair, Hit& hit, int& seen,
                                               ContactSums& sums) const {
    const int slot = previousSlot(node, body);
    hit.previous = slot < 0 ? -1 : previous.row_begin(node) + slot;
    hit.previous_face = -1;
    hit.contact_work = 0;
    hit.has_ended = false;
    const global_id last_face = slot < 0 ? -1 : previous.interactions(hit.previous).face;
    for (; pair < end; ++pair) {
      const int face = pairs.faces(pair);
      if (faces.body(face) != body)
        return;
      if (slot >= 0 && faces.id(face) == last_face &&
          faces.isOfThisStep(pairs.step_test, node, face)) {
        seen |= 1 << slot;
        hit.previous_face = face;
        hit.contact_work = bookWork(hit.previous, face, sums);
      }
    }
  }

  // A node that is much deeper than it was, and than this step can have brought it, has not come through that face but through
  // another one of the body.
  KOKKOS_INLINE_FUNCTION bool hasComeThrough(int node, const Hit& hit) const {
    double known = config.deepest_birth;
    if (hit.depth <= known)
      return true;
    if (hit.previous >= 0) {
      const Interaction& last = previous.interactions(hit.previous);
      known += maxOf(last.depth + last.offset, 0.0);
    }
    const Vec3 motion = faces.relativeMotion(touch.pointOf(faces, node, hit), hit.face, hit.weight);
    return hit.depth <= known - dot(hit.unitNormal(), motion);
  }

  // The cheap tests first. That of the step last, of few pairs: with it the contacts do not depend on the margin.
  KOKKOS_INLINE_FUNCTION bool isTouching(int node, int face, Stage stage, Hit& hit) const {
    return touch.test(faces, node, face, stage, hit) &&
           faces.isOfThisStep(pairs.step_test, node, face);
  }
  KOKKOS_INLINE_FUNCTION int previousSlot(int node, global_id body) const {
    for (int s = 0; s < previous.row_count(node); ++s)
      if (previous.interactions(previous.row_begin(node) + s).body == body)
        return s;
    return -1;
  }

  // Writes interaction `index` of `next`; -1: only counts it.
  KOKKOS_INLINE_FUNCTION void interact(int node, const Hit (&hits)[max_interactions], int num_hits,
                                       int h, std::int64_t index, ContactSums& sums) const {
    const Hit& hit = hits[h];
    Interaction now;
    now.body = faces.body(hit.face);
    now.face = faces.id(hit.face);
    now.node = node;
    now.point = touch.pointOf(faces, node, hit);
    now.face_index = hit.face;
    now.is_held = hit.is_held;
    now.normal = hit.unitNormal();
    for (int j = 0; j < 4; ++j)
      now.weight[j] = hit.weight[j];
    const Vec3 motion = hit.motion;
    now.closing = -dot(now.normal, motion);
    now.inverse_mass = touch.inverseMass(now.point);
    for (int j = 0; j < 4; ++j)
      if (hit.weight[j] != 0)
        now.inverse_mass += hit.weight[j] * hit.weight[j] / faces.attribute(hit.face, j);
    if (goesOn(hit))
      carryOn(now, previous.interactions(hit.previous), hit, touch.stiffnessCap(config, now));
    else
      bear(now, hit.depth, touch.stiffnessAtBirth(config, faces, now, hits, num_hits, h));
    now.depth = hit.depth - now.offset;
    now.first_force = now.stiffness * now.depth;
    FadingForce fading;
    touch.fade(config, faces, hit, now, fading);
    now.force = now.first_force;
    if (config.damping > 0 && now.depth > 0)
      now.first_damping = maxOf(dampingOf(now), -now.first_force);
    now.damping = now.first_damping;
    if (now.taper < 1)
      fading.work = workOf(fading, motion, now, hit.face);
    addTo(sums, now, hit, fading.work);
    FrictionSpring friction;
    if (config.friction > 0)
      rub(now, hit, motion, friction, sums);
    if (index < 0)
      return;
    next.interactions(index) = now;
    if (config.friction > 0)
      next.friction(index) = friction;
    if (now.taper < 1)
      next.fading(index) = fading;
  }

  // All others are births.
  KOKKOS_INLINE_FUNCTION bool goesOn(const Hit& hit) const {
    return hit.previous >= 0 && !hit.has_ended && previous.interactions(hit.previous).depth > 0;
  }

  // What the motion of this step did not bring is taken as an offset: no energy comes from nowhere, and an initial
  // overlap, which is a birth at rest, gives no force.
  KOKKOS_INLINE_FUNCTION static void bear(Interaction& now, double depth, double stiffness) {
    now.stiffness = stiffness;
    now.offset = depth - minOf(depth, maxOf(0.0, now.closing));
  }

  // The spring keeps its energy when the node moves to another face, and when it must become softer: then e may be
  // below 0, and what is stored beyond P comes back in the last step before the node is outside.
  KOKKOS_INLINE_FUNCTION void carryOn(Interaction& now, const Interaction& last, const Hit& hit,
                                      double stiffness_cap) const {
    now.is_new = 0;
    now.taper = last.taper;
    now.stored = last.stored + hit.contact_work;
    now.offset = minOf(last.offset, hit.depth);
    if (last.face != now.face || (last.is_held && !now.is_held)) {
      const double taper = maxOf(touch.taperOf(faces, now.node, hit), least_taper);
      now.offset = hit.depth - maxOf(last.depth, 0.0) * std::sqrt(last.taper / taper);
    }
    now.stiffness = last.stiffness;
    if (stiffness_cap > 0 && stiffness_cap < now.stiffness) {
      const double depth = hit.depth - now.offset;
      now.offset = hit.depth - depth * std::sqrt(now.stiffness / stiffness_cap);
      now.stiffness = stiffness_cap;
    }
    if (last.taper < 1)
      matchStored(now, hit);
  }

  // A contact that was to end beyond an edge, and gave back its energy, but came back after all, holds no more than it has.
  KOKKOS_INLINE_FUNCTION void matchStored(Interaction& now, const Hit& hit) const {
    const double depth = hit.depth - now.offset, stored = maxOf(now.stored, 0.0);
    const double softened = now.stiffness * touch.taperOf(faces, now.node, hit);
    if (depth > 0 && softened * depth * depth > 4 * stored)
      now.offset = hit.depth - std::sqrt(2 * stored / softened);
  }

  // c d-/dt with c = 2 zeta sqrt(k m), m = k dt_ref^2/s <= m_red the mass that k is for.
  KOKKOS_INLINE_FUNCTION double dampingOf(const Interaction& now) const {
    const double c = 2 * config.damping * now.stiffness * now.taper * config.reference_step /
                     std::sqrt(config.penalty);
    return c * now.closing / dt;
  }

  KOKKOS_INLINE_FUNCTION void rub(const Interaction& now, const Hit& hit, const Vec3& motion,
                                  FrictionSpring& friction, ContactSums& sums) const {
    friction.stiffness = config.friction_stiffness * now.stiffness;
    if (!(now.depth > 0 && friction.stiffness > 0) || now.is_held)
      return; // nearly parallel edges could not give back the couple of a force across both
    touch.setLevers(faces, now, hit.depth, friction.lever);
    friction.motion = along(slipOf(friction, motion, now, hit.face), now.normal);
    Vec3 held;
    if (goesOn(hit)) {
      const FrictionSpring& last = previous.friction(hit.previous);
      held = turnedInto(last.force, now.normal);
      if (friction.stiffness < last.stiffness) // softer at equal stored energy
        held = std::sqrt(friction.stiffness / last.stiffness) * held;
    }
    friction.trial = held - friction.stiffness * friction.motion;
    friction.force = slipped(friction.trial, config.friction * (now.force + now.damping));
    sums.terms.add(friction_stored, 0.5 * dot(held, friction.force) / friction.stiffness,
                   energy_scale);
  }

  // What the friction force works on: the motion of the node, and that of the face's corners along the normal, which the
  // couple acts on.
  KOKKOS_INLINE_FUNCTION Vec3 slipOf(const FrictionSpring& friction, const Vec3& motion,
                                     const Interaction& pair, int face) const {
    double slope[2];
    touch.slopesOfMotion(faces, pair, face, slope);
    return motion - slope[0] * friction.lever[0] - slope[1] * friction.lever[1];
  }

  KOKKOS_INLINE_FUNCTION double workOf(const FadingForce& force, const Vec3& relative_motion,
                                       const Interaction& pair, int face) const {
    Vec3 of_corner[4];
    for (int j = 0; j < 4; ++j)
      of_corner[j] = faces.cornerMotion(face, j);
    return force.times(pair.normal, relative_motion, of_corner,
                       faces.nodeMotion(pair.point.node[1]) - faces.nodeMotion(pair.point.node[0]));
  }

  // Books the work of the last step's forces over the half step before and after them, of which the second half is the
  // motion of this step. Returns the work done on the contact's spring: dt F n . (v^{n-1/2} + v^{n+1/2})/2 and its fading part.
  KOKKOS_INLINE_FUNCTION double bookWork(int index, int last_face, ContactSums& sums) const {
    const Interaction& last = previous.interactions(index);
    const Vec3 motion = faces.relativeMotion(last.point, last_face, last.weight);
    const double kick = 0.5 * (previous_dt + dt);
    const double closing =
        kick * 0.5 * (last.closing / previous_dt - dot(last.normal, motion) / dt);
    double on_spring = last.force * closing;
    if (last.taper < 1) {
      const FadingForce& fading = previous.fading(index);
      on_spring -=
          kick * 0.5 * (fading.work / previous_dt + workOf(fading, motion, last, last_face) / dt);
    }
    if (Touch::books_spring_work)
      sums.terms.add(spring_work, -on_spring, energy_scale);
    if (last.damping != 0)
      sums.terms.add(damping_work, -last.damping * closing, energy_scale);
    if (config.friction > 0) {
      const FrictionSpring& friction = previous.friction(index);
      sums.terms.add(friction_work,
                     kick * 0.5 *
                         (dot(friction.force, friction.motion) / previous_dt +
                          dot(friction.force, slipOf(friction, motion, last, last_face)) / dt),
                     energy_scale);
    }
    return on_spring;
  }

  KOKKOS_INLINE_FUNCTION void addTo(ContactSums& sums, const Interaction& now, const Hit& hit,
                                    double fading_work) const {
    ++sums.interactions;
    sums.active += now.depth > 0;
    if (now.depth > 0) {
      sums.max_penetration = maxOf(sums.max_penetration, touch.relativeDepth(faces, hit));
      sums.deepest = maxOf(sums.deepest, hit.depth);
    }
    if (!goesOn(hit))
      return;
    sums.terms.add(spring_stored,
                   storedBetween(previous.interactions(hit.previous), now, hit, fading_work),
                   energy_scale);
  }
  // At the half step: (U^n + U^{n+1})/2 - (W^n - W^{n+1})/4, U = k w p^2/2, W^n the work of the forces of x^n over the motion between the two;
  // without fading that is k p^n p^{n+1}/2.
  KOKKOS_INLINE_FUNCTION double storedBetween(const Interaction& last, const Interaction& now,
                                              const Hit& hit, double fading_work) const {
    const double stiffness = std::sqrt(last.stiffness * now.stiffness);
    if ((last.taper == 1 && now.taper == 1) || last.face != now.face ||
        !(last.depth > 0 && now.depth > 0))
      return 0.25 * stiffness * (last.taper + now.taper) * last.depth * now.depth;
    const Vec3 motion = faces.relativeMotion(last.point, hit.face, last.weight);
    double last_work = -last.first_force * -dot(last.normal, motion);
    if (last.taper < 1) { // before its correction, as the other forces here
      const FadingForce& fading = previous.fading(hit.previous);
      if (fading.factor > 0)
        last_work += workOf(fading, motion, last, hit.face) / fading.factor;
    }
    const double work = fading_work - now.first_force * now.closing;
    return 0.25 * stiffness *
               (last.taper * last.depth * last.depth + now.taper * now.depth * now.depth) -
           0.25 * (last_work - work);
  }

  // A loaded contact cannot leave the candidates (boxes hold x^n and x^{n+1}) unless it is deeper than their tolerance.
  KOKKOS_INLINE_FUNCTION void countLost(int node, int seen, ContactSums& sums) const {
    for (int s = 0; s < previous.row_count(node); ++s)
      if (!(seen & (1 << s)) && previous.interactions(previous.row_begin(node) + s).depth > 0)
        ++sums.lost;
  }
};

} // namespace brickwall::contact
