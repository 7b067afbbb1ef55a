// The state of a contact that has been chosen, in a step: birth and what goes on, stiffness, forces before any correction, friction,
// and the works and energies that are booked for it. Kernel part of SelectInteractions.
#pragma once

#include "contact/enforcement/law/contact_sums.hpp"
#include "contact/enforcement/law/coulomb_friction.hpp"
#include "contact/enforcement/law/enforcement_config.hpp"
#include "contact/enforcement/law/face_contact.hpp"
#include "contact/enforcement/law/pair_forces.hpp"

namespace brickwall::contact {

template <class Kinematics>
struct InteractionForces {
  static constexpr double least_taper = 0.01; // below it a switch does not keep the energy

  EnforcementConfig config;
  LimbScale energy_scale;
  double dt, previous_dt;
  Kinematics touch;
  FaceAccess faces = {{}, GhostFaces::none()};
  ContactHistory previous;
  ContactHistory next; // interactions beyond its extent are counted, not written
  PairForces add; // takes the forces of what is written to `next`

  // Writes interaction `index` of `next`; -1: only counts it.
  KOKKOS_INLINE_FUNCTION void interact(int node, const FaceContact (&hits)[max_interactions],
                                       int num_hits, int h, std::int64_t index,
                                       ContactSums& sums) const {
    const FaceContact& hit = hits[h];
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
    now.inverse_mass = Kinematics::knows_motion && hit.known != nullptr
                           ? hit.known->inverse_mass
                           : inverseMass(now, hit.face);
    if (goesOn(hit))
      continueContact(now, previous.interactions(hit.previous), hit,
                      touch.stiffnessCap(config, now));
    else
      startContact(now, hit.depth, touch.stiffnessAtBirth(config, faces, now, hits, num_hits, h));
    now.depth = hit.depth - now.offset;
    now.first_force = now.stiffness * now.depth;
    FadingForce fading;
    touch.fade(config, faces, hit, now, fading);
    now.force = now.first_force;
    if (config.damping > 0 && now.depth > 0)
      now.first_damping = maxOf(dampingOf(now), -now.first_force);
    now.damping = now.first_damping;
    if (now.fade_weight < 1)
      fading.work = workOf(fading, motion, now, hit.face);
    addTo(sums, now, hit);
    if (goesOn(hit)) {
      const Interaction& last = previous.interactions(hit.previous);
      const double held = storedBetween(last, now, hit, fading.work);
      sums.terms.add(spring_stored, toBeReturned(held, now.stored, last.is_new != 0), energy_scale);
      if (config.scheme == Scheme::energy_neutral)
        followWork(now, held);
    }
    FrictionSpring friction;
    if (config.friction > 0)
      applyFriction(now, hit, motion, friction, sums);
    if (index < 0)
      return;
    next.interactions(index) = now;
    if (config.friction > 0)
      next.friction(index) = friction;
    if (now.fade_weight < 1)
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
        inverse_mass += pair.weight[j] * pair.weight[j] / faces.cornerMass(face, j);
    return inverse_mass;
  }

  // All others are births.
  KOKKOS_INLINE_FUNCTION bool goesOn(const FaceContact& hit) const {
    return hit.previous >= 0 && !hit.has_ended && previous.interactions(hit.previous).depth > 0;
  }

  // What the motion of this step did not bring is taken as an offset: no energy comes from nowhere, and an initial
  // overlap, which is a birth at rest, gives no force.
  KOKKOS_INLINE_FUNCTION static void startContact(Interaction& now, double depth,
                                                  double stiffness) {
    now.stiffness = stiffness;
    now.offset = depth - minOf(depth, maxOf(0.0, now.closing));
  }

  // The spring goes on closing as the last force did when the node moves to another face, and keeps its energy when it must become
  // softer: then e may be below 0, and what is stored beyond P comes back in the last step before the node is outside.
  KOKKOS_INLINE_FUNCTION void continueContact(Interaction& now, const Interaction& last,
                                              const FaceContact& hit, double stiffness_cap) const {
    now.is_new = 0;
    now.fade_weight = last.fade_weight;
    now.stored = last.stored + hit.contact_work;
    now.offset = minOf(last.offset, hit.depth);
    if (last.face != now.face || (last.is_held && !now.is_held)) {
      const double fade_weight = maxOf(touch.fadeWeightOf(faces, now.node, hit), least_taper);
      const double depth = maxOf(last.depth + hit.closing_before, 0.0);
      now.offset = hit.depth - depth * std::sqrt(last.fade_weight / fade_weight);
    }
    now.stiffness = last.stiffness;
    soften(stiffness_cap, hit.depth, now.stiffness, now.offset);
    if (last.fade_weight < 1)
      matchStored(now, last, hit);
  }

  // Where the cap falls below the stiffness, at equal stored energy.
  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION static void soften(const Real& cap, const Real& penetration,
                                                 Real& stiffness, Real& offset) {
    const auto is_softer = (cap > Real(0.0)) & (cap < stiffness);
    const Real depth = penetration - offset;
    offset = where(is_softer, penetration - depth * squareRoot(stiffness / cap), offset);
    stiffness = where(is_softer, cap, stiffness);
  }

  // A contact that was to end beyond an edge, and gave back its energy, but came back after all, holds no more than it has: at the
  // half step, k w p^n p^{n+1}/2.
  KOKKOS_INLINE_FUNCTION void matchStored(Interaction& now, const Interaction& last,
                                          const FaceContact& hit) const {
    const double depth = hit.depth - now.offset, stored = maxOf(now.stored, 0.0);
    const double fade_weight = 0.5 * (last.fade_weight + touch.fadeWeightOf(faces, now.node, hit));
    const double softened = now.stiffness * fade_weight;
    if (depth > 0 && softened * last.depth * depth > 4 * stored)
      now.offset = hit.depth - 2 * stored / (softened * last.depth);
  }

  // Where normals turn and faces change, what the spring holds drifts from the work that was done on it, more than the last step
  // could give back. So from the next step on the spring feels a little more, or less, until half of what is missing is made up.
  KOKKOS_INLINE_FUNCTION static void followWork(Interaction& now, double held) {
    now.offset = offsetThatFollows(now.offset, now.stored, held, now.fade_weight * now.depth,
                                   now.stiffness * now.fade_weight * now.depth, now.depth);
  }
  // `force`: of the spring, at the depth that it feels tapered.
  template <class Real>
  KOKKOS_INLINE_FUNCTION static Real offsetThatFollows(const Real& offset, const Real& stored,
                                                       const Real& held, const Real& tapered,
                                                       const Real& force, const Real& depth) {
    constexpr double noise = 1e-9, most = 0.1; // of the energy; of p
    const Real missing = stored - held;
    const auto follows = (tapered > Real(0.0)) & (magnitude(missing) > noise * magnitude(stored));
    const Real change = minOf(maxOf(missing / force, -most * depth), most * depth);
    return where(follows, offset - change, offset);
  }

  // What a contact that began in the step before is booked to store. Its first force was corrected, to nothing where its end was in
  // sight, and so will be that of this step: if the contact ends with it, it gives back the work done on it, and not what the
  // spring, whose force has hardly acted, seems to hold. From the next step on the spring answers for what it holds.
  template <class Real, class Mask>
  KOKKOS_FORCEINLINE_FUNCTION Real toBeReturned(const Real& held, const Real& stored,
                                                const Mask& was_new) const {
    if (config.scheme != Scheme::energy_neutral)
      return held;
    return where(was_new, minOf(held, maxOf(stored, Real(0.0))), held);
  }

  // c d-/dt with c = 2 zeta sqrt(k m), m = k dt_ref^2/s <= m_red the mass that k is for.
  KOKKOS_INLINE_FUNCTION double dampingOf(const Interaction& now) const {
    const double c = 2 * config.damping * now.stiffness * now.fade_weight * config.reference_step /
                     std::sqrt(config.penalty);
    return c * now.closing / dt;
  }

  KOKKOS_INLINE_FUNCTION void applyFriction(const Interaction& now, const FaceContact& hit,
                                            const Vec3& motion, FrictionSpring& friction,
                                            ContactSums& sums) const {
    friction.stiffness = config.friction_stiffness * now.stiffness;
    if (!(now.depth > 0 && friction.stiffness > 0) || now.is_held)
      return; // nearly parallel edges could not give back the couple of a force across both
    touch.setLevers(faces, now, hit.depth, friction.lever);
    friction.motion = tangentialPart(slipOf(friction, motion, now, hit.face), now.normal);
    Vec3 held;
    if (goesOn(hit)) {
      const FrictionSpring& last = previous.friction(hit.previous);
      held = rotateToPlane(last.force, now.normal);
      if (friction.stiffness < last.stiffness) // softer at equal stored energy
        held = std::sqrt(friction.stiffness / last.stiffness) * held;
    }
    friction.trial = held - friction.stiffness * friction.motion;
    friction.force = returnMap(friction.trial, config.friction * (now.force + now.damping));
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

  // Over the half step before the last forces and the one after them, from the motions of the steps.
  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION Real closingOfKick(const Real& before, const Real& now) const {
    return 0.5 * (previous_dt + dt) * 0.5 * (before / previous_dt + now / dt);
  }

  // Books the work of the last step's forces over the half step before and after them, of which the second half is the
  // motion of this step. Returns the work done on the contact's spring: dt F n . (v^{n-1/2} + v^{n+1/2})/2 and its fading part.
  // `closing_now`: that motion of this step, along the last normal.
  KOKKOS_INLINE_FUNCTION double bookWork(const PersistentContact& known, double closing_now,
                                         ContactSums& sums) const {
    const int index = known.previous, last_face = known.face;
    const Interaction& last = previous.interactions(index);
    const Vec3& motion = known.last_motion;
    const double kick = 0.5 * (previous_dt + dt);
    const double closing = closingOfKick(last.closing, closing_now);
    double on_spring = last.force * closing;
    if (last.fade_weight < 1) {
      const FadingForce& fading = previous.fading(index);
      on_spring -=
          kick * 0.5 * (fading.work / previous_dt + workOf(fading, motion, last, last_face) / dt);
    }
    if (Kinematics::books_spring_work)
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

  KOKKOS_INLINE_FUNCTION void addTo(ContactSums& sums, const Interaction& now,
                                    const FaceContact& hit) const {
    ++sums.interactions;
    sums.active += now.depth > 0;
    if (now.depth > 0) {
      sums.max_penetration = maxOf(sums.max_penetration, touch.relativeDepth(faces, hit));
      sums.deepest = maxOf(sums.deepest, hit.depth);
    }
  }
  // k p^n p^{n+1}/2, with the sum of the tapers w^n and w^{n+1} for 2.
  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION static Real
  storedWithoutFading(const Real& last_stiffness, const Real& stiffness, const Real& tapers,
                      const Real& last_depth, const Real& depth) {
    return 0.25 * squareRoot(last_stiffness * stiffness) * tapers * last_depth * depth;
  }
  // At the half step: (U^n + U^{n+1})/2 - (W^n - W^{n+1})/4, U = k w p^2/2, W^n the work of the forces of x^n over the motion between the two;
  // without fading that is k p^n p^{n+1}/2.
  KOKKOS_INLINE_FUNCTION double storedBetween(const Interaction& last, const Interaction& now,
                                              const FaceContact& hit, double fading_work) const {
    if ((last.fade_weight == 1 && now.fade_weight == 1) || last.face != now.face ||
        !(last.depth > 0 && now.depth > 0))
      return storedWithoutFading(last.stiffness, now.stiffness, last.fade_weight + now.fade_weight,
                                 last.depth, now.depth);
    const double stiffness = std::sqrt(last.stiffness * now.stiffness);
    const Vec3 motion = faces.relativeMotion(last.point, hit.face, last.weight);
    double last_work = -last.first_force * -dot(last.normal, motion);
    if (last.fade_weight < 1) { // before its correction, as the other forces here
      const FadingForce& fading = previous.fading(hit.previous);
      if (fading.factor > 0)
        last_work += workOf(fading, motion, last, hit.face) / fading.factor;
    }
    const double work = fading_work - now.first_force * now.closing;
    return 0.25 * stiffness *
               (last.fade_weight * last.depth * last.depth +
                now.fade_weight * now.depth * now.depth) -
           0.25 * (last_work - work);
  }
};

} // namespace brickwall::contact
