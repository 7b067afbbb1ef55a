// Which faces each node (or edge) is in contact with, and the state of those contacts: one face of each opposing body, kept
// while it lasts; birth, switch, stiffness and friction as penalty.hpp states them; and their forces, before any correction.
// Kernel functor.
//
// `Touch` knows the geometry: NodeFaceTouch or EdgeTouch.
#pragma once

#include "contact/contact_sums.hpp"
#include "contact/coulomb_friction.hpp"
#include "contact/enforcement_config.hpp"
#include "contact/face_access.hpp"
#include "contact/known_contact.hpp"
#include "contact/pair_forces.hpp"
#include "contact/still_parts.hpp"

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
  const KnownContact*
      known; // what is known of the contact with that face; null where the hit is another
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

// Rows of candidates, one per surface node, some at once: tests the node against its candidates, chooses one face of each opposing
// body and writes the node's row of `next`. Rows of candidates are in the order of (body, face id), so ties go to the lower id.
// Rows without history whose candidates cannot be touched (Touch::mayTouch) are left as they are: row_count must be 0 before, and
// what Touch::record() writes that of no contact. Contacts that go on are looked at together.
template <class Touch>
struct SelectInteractions {
  using value_type = ContactSums;

  static constexpr double least_taper = 0.01; // below it a switch does not keep the energy
  static constexpr int rows_at_once = simd_width > 1 ? 32 : 1;
  static constexpr int max_known = simd_width > 1 ? 2 * rows_at_once : max_interactions;

  EnforcementConfig config;
  LimbScale energy_scale;
  double dt, previous_dt;
  Touch touch;
  FaceAccess faces = {{}, GhostFaces::none()};
  CandidatePairs pairs = CandidatePairs::none();
  StillFlags still;
  ContactHistory previous;
  ContactHistory next; // interactions beyond its extent are counted, not written
  PairForces add; // takes the forces of what is written to `next`
  View<std::int64_t> next_count;

  // Rows with something to do, and the contacts that they go on with: row r has known[first[r]] .. known[first[r + 1] - 1].
  struct Work {
    int num_rows = 0, num_known = 0;
    std::int64_t rows[rows_at_once];
    int first[rows_at_once + 1];
    KnownContact known[max_known];
  };

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t part, ContactSums& sums) const {
    const std::int64_t begin = part * rows_at_once;
    const std::int64_t end = minOf<std::int64_t>(begin + rows_at_once, pairs.num_rows);
    std::int64_t to_see[rows_at_once];
    int num_to_see = 0;
    for (std::int64_t row = begin; row < end; ++row)
      if (!still.isClear(pairs, row))
        to_see[num_to_see++] = row;
    if (num_to_see == 0)
      return;
    for (int r = 0; r < num_to_see; ++r)
      prefetchHead(pairs.node(to_see[r]));
    for (int r = 0; r < num_to_see; ++r)
      prefetchRow(to_see[r]);
    Work work;
    for (int r = 0; r < num_to_see; ++r) {
      const std::int64_t row = to_see[r];
      const int node = pairs.node(row), count = previous.row_count(node);
      const bool is_clear = count == 0 && !mayTouchAny(row, node);
      still.clear(node) = is_clear;
      if (is_clear)
        continue;
      if (work.num_known + count > max_known)
        finish(work, sums);
      work.rows[work.num_rows] = row;
      work.first[work.num_rows++] = work.num_known;
      if (count > 0)
        findKnown(row, node, count, work);
    }
    finish(work, sums);
  }
  // What is read of a row comes from many places: all of them are asked for before any is waited for.
  KOKKOS_FORCEINLINE_FUNCTION void prefetchHead(int node) const {
    touch.prefetchHead(node);
    prefetch(&previous.row_count(node));
    prefetch(&previous.row_begin(node));
  }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchRow(std::int64_t row) const {
    const int node = pairs.node(row);
    const std::int64_t end = pairs.end(row);
    for (std::int64_t p = pairs.begin(row); p < end; ++p)
      touch.prefetchFace(pairs.faces(p));
    faces.prefetchRow(faces.surface.coordinates_new, node);
    if (previous.row_count(node) == 0)
      return;
    faces.prefetchRow(faces.surface.coordinates_old, node);
    const Interaction& last = previous.interactions(previous.row_begin(node));
    prefetch(&last.body);
    prefetch(&last.force);
    prefetch(&last.first_force);
    prefetch(&faces.surface.node_body(node));
    touch.prefetchNode(node);
  }
  KOKKOS_INLINE_FUNCTION bool mayTouchAny(std::int64_t row, int node) const {
    const std::int64_t end = pairs.end(row);
    for (std::int64_t p = pairs.begin(row); p < end; ++p)
      if (touch.mayTouch(faces, node, pairs.faces(p)))
        return true;
    return false;
  }
  KOKKOS_INLINE_FUNCTION void findKnown(std::int64_t row, int node, int count, Work& work) const {
    const std::int64_t end = pairs.end(row);
    const int first = previous.row_begin(node);
    int missing = count;
    for (std::int64_t p = pairs.begin(row); p < end && missing > 0; ++p) {
      const int face = pairs.faces(p);
      const global_id id = touch.idOf(faces, face);
      for (int s = 0; s < count; ++s) {
        if (previous.interactions(first + s).face != id)
          continue;
        --missing;
        if (!faces.isOfThisStep(pairs.step_test, node, face))
          continue;
        KnownContact& contact = work.known[work.num_known++];
        contact.node = node;
        contact.slot = s;
        contact.previous = first + s;
        contact.face = face;
        faces.prefetchFace(face);
      }
    }
  }
  KOKKOS_INLINE_FUNCTION void finish(Work& work, ContactSums& sums) const {
    touch.look(faces, previous, work.num_known, work.known);
    work.first[work.num_rows] = work.num_known;
    for (int r = 0; r < work.num_rows; ++r)
      selectOfRow(work.rows[r], work.known + work.first[r], work.first[r + 1] - work.first[r],
                  sums);
    work.num_rows = work.num_known = 0;
  }

  KOKKOS_INLINE_FUNCTION void selectOfRow(std::int64_t row, const KnownContact* known,
                                          int num_known, ContactSums& sums) const {
    const int node = pairs.node(row);
    Hit hits[max_interactions];
    int seen = 0; // bit s: the face of the node's previous interaction s is still a candidate
    for (int k = 0; k < num_known; ++k)
      seen |= 1 << known[k].slot;
    const int num_hits = findHits(row, node, known, num_known, hits, sums);
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
    std::int64_t index = takePlaces(num_loaded);
    next.row_begin(node) = static_cast<int>(index);
    for (int h = 0; h < num_hits; ++h) {
      if (!hits[h].is_loaded)
        continue;
      const bool has_room = index < static_cast<std::int64_t>(next.interactions.extent(0));
      interact(node, hits, num_hits, h, has_room ? index : -1, sums);
      ++index;
    }
  }

  KOKKOS_INLINE_FUNCTION std::int64_t takePlaces(std::int64_t count) const {
    if (!add.is_alone)
      return Kokkos::atomic_fetch_add(next_count.data(), count);
    const std::int64_t first = next_count();
    next_count() = first + count;
    return first;
  }

  // One hit per opposing body. Returns their number.
  KOKKOS_INLINE_FUNCTION int findHits(std::int64_t row, int node, const KnownContact* known,
                                      int num_known, Hit (&hits)[max_interactions],
                                      ContactSums& sums) const {
    const std::int64_t end = pairs.end(row);
    const global_id own_body = faces.surface.node_body(node);
    int num_hits = 0;
    for (std::int64_t pair = pairs.begin(row); pair < end;) {
      const global_id body = touch.bodyOf(faces, pairs.faces(pair));
      const std::int64_t begin = pair;
      while (pair < end && touch.bodyOf(faces, pairs.faces(pair)) == body)
        ++pair;
      Hit hit;
      recall(node, body, known, num_known, hit, sums);
      const bool wanted = (body != own_body || config.self_contact) && touch.pushes(own_body, body);
      if (!wanted || !findHitOnBody(node, begin, pair, hit))
        continue;
      if (num_hits < max_interactions)
        hits[num_hits++] = hit;
      else
        ++sums.overflow;
    }
    return num_hits;
  }

  // The face of a body, of its candidates [begin, end), that the node is in contact with: the last one if it still is under load,
  // else the least penetrated.
  KOKKOS_INLINE_FUNCTION bool findHitOnBody(int node, std::int64_t begin, std::int64_t end,
                                            Hit& hit) const {
    // A contact without load is chosen anew: else a node that slid in beside a face would stay with it for ever.
    const bool is_loaded = hit.previous >= 0 && previous.interactions(hit.previous).depth > 0;
    const bool has_face = is_loaded && hit.previous_face >= 0;
    if (has_face && touch.testAgain(faces, *hit.known, hit))
      return true;
    hit.known = nullptr;
    // Where it went out through the face, the contact has ended and given back its energy; what it touches now, it meets anew.
    hit.has_ended = has_face && touch.isOutside(faces, node, hit.previous_face);
    if (findNearest(node, begin, end, Stage::born, is_loaded, hit))
      return true;
    if (!is_loaded || hit.has_ended)
      return false;
    return findNearest(node, begin, end, Stage::switched, is_loaded, hit) ||
           (has_face && isTouching(node, hit.previous_face, Stage::held, hit));
  }

  // Whether the contact has a force, for all that is known yet. One without is forgotten: the next step chooses its face anew, and
  // takes the penetration that it finds as the offset.
  KOKKOS_INLINE_FUNCTION bool bearsLoad(int node, Hit& hit) const {
    hit.motion = Touch::knows_motion && hit.known != nullptr
                     ? hit.known->motion
                     : faces.relativeMotion(touch.pointOf(faces, node, hit), hit.face, hit.weight);
    if (!goesOn(hit))
      return dot(hit.unitNormal(), hit.motion) < 0;
    const Interaction& last = previous.interactions(hit.previous);
    return last.face != touch.idOf(faces, hit.face) || last.is_held != hit.is_held ||
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
    nearest.known = nullptr;
    nearest.previous = hit.previous;
    nearest.previous_face = hit.previous_face;
    nearest.contact_work = hit.contact_work;
    nearest.has_ended = hit.has_ended;
    hit = nearest;
    return true;
  }

  // What the node touched on `body` at the last step, if that face is among its candidates, and the work that its forces did since.
  KOKKOS_INLINE_FUNCTION void recall(int node, global_id body, const KnownContact* known,
                                     int num_known, Hit& hit, ContactSums& sums) const {
    const int slot = previousSlot(node, body);
    hit.previous = slot < 0 ? -1 : previous.row_begin(node) + slot;
    hit.previous_face = -1;
    hit.known = nullptr;
    hit.contact_work = 0;
    hit.has_ended = false;
    for (int k = 0; k < num_known; ++k)
      if (known[k].slot == slot) {
        hit.known = &known[k];
        hit.previous_face = known[k].face;
        hit.contact_work = bookWork(known[k], sums);
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
    now.body = touch.bodyOf(faces, hit.face);
    now.face = touch.idOf(faces, hit.face);
    now.node = node;
    now.point = touch.pointOf(faces, node, hit);
    now.face_index = hit.face;
    now.is_held = hit.is_held;
    now.normal = hit.unitNormal();
    for (int j = 0; j < 4; ++j)
      now.weight[j] = hit.weight[j];
    const Vec3 motion = hit.motion;
    now.closing = -dot(now.normal, motion);
    now.inverse_mass = Touch::knows_motion && hit.known != nullptr ? hit.known->inverse_mass
                                                                   : inverseMass(now, hit.face);
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
    if (now.first_force == 0)
      return;
    PairQuanta quanta;
    if (add.round(now, friction, fading, quanta))
      add.add(now, quanta, 1);
    else
      ++sums.invalid;
  }

  KOKKOS_INLINE_FUNCTION double inverseMass(const Interaction& pair, int face) const {
    double inverse_mass = touch.inverseMass(pair.point);
    for (int j = 0; j < 4; ++j)
      if (pair.weight[j] != 0)
        inverse_mass += pair.weight[j] * pair.weight[j] / faces.attribute(face, j);
    return inverse_mass;
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
  KOKKOS_INLINE_FUNCTION double bookWork(const KnownContact& known, ContactSums& sums) const {
    const int index = known.previous, last_face = known.face;
    const Interaction& last = previous.interactions(index);
    const Vec3& motion = known.last_motion;
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
