// The contact law for one selected contact in one step: activation and continuation, stiffness,
// normal, damping, friction and fading forces before the energy-neutral correction, and the works
// and energies for the ledger; eqs. (9) to (14), (16), (20) to (27) of theory.md. Kernel part of
// SelectInteractions.
#pragma once

#include "contact/enforcement/law/contact_sums.hpp"
#include "contact/enforcement/law/coulomb_friction.hpp"
#include "contact/enforcement/law/enforcement_config.hpp"
#include "contact/enforcement/law/face_contact.hpp"
#include "contact/enforcement/law/pair_forces.hpp"

namespace brickwall::contact {

template <class Kinematics>
struct InteractionForces {
  // below it a transfer to another face does not keep the energy
  static constexpr double min_fade_weight = 0.01;

  EnforcementConfig config;
  LimbScale energy_scale;
  double dt, previous_dt;
  Kinematics kinematics;
  FaceAccess faces = {{}, GhostFaces::none()};
  ContactHistory previous;
  ContactHistory next; // interactions beyond its extent are counted, not written
  PairForces add; // accumulates the forces of the interactions written to `next`

  // Writes interaction `index` of `next`; -1: only counts it.
  KOKKOS_INLINE_FUNCTION void writeInteraction(int node,
                                               const FaceContact (&contacts)[max_interactions],
                                               int num_contacts, int h, std::int64_t index,
                                               ContactSums& sums) const {
    const FaceContact& contact = contacts[h];
    Interaction now;
    now.body = kinematics.bodyOf(faces, contact.face);
    now.face = kinematics.idOf(faces, contact.face);
    now.node = node;
    now.point = kinematics.pointOf(faces, node, contact);
    now.face_index = contact.face;
    now.is_retained = contact.is_retained;
    now.normal = contact.unitNormal();
    for (int j = 0; j < 4; ++j)
      now.weight[j] = contact.weight[j];
    const Vec3 motion = contact.motion;
    now.closing = -dot(now.normal, motion);
    now.inverse_mass = Kinematics::projects_persistent_contacts && contact.persistent != nullptr
                           ? contact.persistent->inverse_mass
                           : inverseMass(now, contact.face);
    if (isPersistent(contact))
      persist(now, previous.interactions(contact.previous), contact,
              kinematics.stiffnessCap(config, now));
    else
      activate(now, contact.depth,
               kinematics.stiffnessAtActivation(config, faces, now, contacts, num_contacts, h));
    now.depth = contact.depth - now.offset;
    now.first_force = now.stiffness * now.depth;
    FadingForce fading;
    kinematics.fade(config, faces, contact, now, fading);
    now.force = now.first_force;
    if (config.damping > 0 && now.depth > 0)
      now.first_damping = maxOf(dampingOf(now), -now.first_force);
    now.damping = now.first_damping;
    if (now.fade_weight < 1)
      fading.work = workOf(fading, motion, now, contact.face);
    count(sums, now, contact);
    if (isPersistent(contact)) {
      const Interaction& last = previous.interactions(contact.previous);
      const double spring_energy = storedAtHalfStep(last, now, contact, fading.work);
      sums.terms.add(spring_stored, recoverableEnergy(spring_energy, now.stored, last.is_new != 0),
                     energy_scale);
      if (config.scheme == Scheme::energy_neutral)
        adjustOffset(now, spring_energy);
    }
    FrictionSpring friction;
    if (config.friction > 0)
      applyFriction(now, contact, motion, friction, sums);
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
    double inverse_mass = kinematics.inverseMass(pair.point);
    for (int j = 0; j < 4; ++j)
      if (pair.weight[j] != 0)
        inverse_mass += pair.weight[j] * pair.weight[j] / faces.cornerMass(face, j);
    return inverse_mass;
  }

  // All other contacts become active in this step.
  KOKKOS_INLINE_FUNCTION bool isPersistent(const FaceContact& contact) const {
    return contact.previous >= 0 && !contact.has_ended &&
           previous.interactions(contact.previous).depth > 0;
  }

  // Activation, eq. (9). The part of the penetration that this step's motion did not cause is
  // stored as the offset e, so that no energy is created: an initial overlap, which is an
  // activation at rest, gives no force.
  KOKKOS_INLINE_FUNCTION static void activate(Interaction& now, double depth, double stiffness) {
    now.stiffness = stiffness;
    now.offset = depth - minOf(depth, maxOf(0.0, now.closing));
  }

  // Continuation. When the contact moves to another face, the deformation p continues with the
  // approach of this step; when the stiffness is reduced, p grows so that the energy is kept, eq.
  // (13). Then e may be negative, and the energy stored beyond P is returned in the last step
  // before the node is in front of the face.
  KOKKOS_INLINE_FUNCTION void persist(Interaction& now, const Interaction& last,
                                      const FaceContact& contact, double stiffness_cap) const {
    now.is_new = 0;
    now.fade_weight = last.fade_weight;
    now.stored = last.stored + contact.contact_work;
    now.offset = minOf(last.offset, contact.depth);
    if (last.face != now.face || (last.is_retained && !now.is_retained)) {
      const double fade_weight =
          maxOf(kinematics.fadeWeightOf(faces, now.node, contact), min_fade_weight);
      const double depth = maxOf(last.depth + contact.closing_at_last_point, 0.0);
      now.offset = contact.depth - depth * std::sqrt(last.fade_weight / fade_weight);
    }
    now.stiffness = last.stiffness;
    soften(stiffness_cap, contact.depth, now.stiffness, now.offset);
    if (last.fade_weight < 1)
      limitStoredEnergy(now, last, contact);
  }

  // Reduces the stiffness to the cap at equal stored energy; eq. (13).
  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION static void soften(const Real& cap, const Real& penetration,
                                                 Real& stiffness, Real& offset) {
    const auto is_softer = (cap > Real(0.0)) & (cap < stiffness);
    const Real depth = penetration - offset;
    offset = where(is_softer, penetration - depth * squareRoot(stiffness / cap), offset);
    stiffness = where(is_softer, cap, stiffness);
  }

  // A contact that was about to end beyond an edge has returned its energy. If it loads again, it
  // stores no more than the work done on it, with the energy k w p^n p^{n+1}/2 at the half step.
  KOKKOS_INLINE_FUNCTION void limitStoredEnergy(Interaction& now, const Interaction& last,
                                                const FaceContact& contact) const {
    const double depth = contact.depth - now.offset, stored = maxOf(now.stored, 0.0);
    const double fade_weight =
        0.5 * (last.fade_weight + kinematics.fadeWeightOf(faces, now.node, contact));
    const double softened = now.stiffness * fade_weight;
    if (depth > 0 && softened * last.depth * depth > 4 * stored)
      now.offset = contact.depth - 2 * stored / (softened * last.depth);
  }

  // Where normals rotate and faces change, the energy of the spring drifts from the work that was
  // done on it, by more than the last step can return. Half of the difference is made up from the
  // next step on by changing e; eq. (20).
  KOKKOS_INLINE_FUNCTION static void adjustOffset(Interaction& now, double spring_energy) {
    now.offset = adjustedOffset(now.offset, now.stored, spring_energy, now.fade_weight * now.depth,
                                now.stiffness * now.fade_weight * now.depth, now.depth);
  }
  // `force` is that of the spring at `faded_depth` = w p.
  template <class Real>
  KOKKOS_INLINE_FUNCTION static Real
  adjustedOffset(const Real& offset, const Real& stored, const Real& spring_energy,
                 const Real& faded_depth, const Real& force, const Real& depth) {
    constexpr double noise = 1e-9, max_share = 0.1; // relative to the energy, and to p
    const Real deficit = stored - spring_energy;
    const auto follows =
        (faded_depth > Real(0.0)) & (magnitude(deficit) > noise * magnitude(stored));
    const Real change = minOf(maxOf(deficit / force, -max_share * depth), max_share * depth);
    return where(follows, offset - change, offset);
  }

  // Energy to record for a contact in its second step. Its first force was corrected, to zero if
  // the end of the contact was in sight, and so will be that of this step. If the contact ends with
  // this step, it returns the work done on it, and not the energy that the uncorrected spring would
  // hold. From the next step on the energy is that of the spring.
  template <class Real, class Mask>
  KOKKOS_FORCEINLINE_FUNCTION Real recoverableEnergy(const Real& spring_energy, const Real& stored,
                                                     const Mask& was_new) const {
    if (config.scheme != Scheme::energy_neutral)
      return spring_energy;
    return where(was_new, minOf(spring_energy, maxOf(stored, Real(0.0))), spring_energy);
  }

  // c d-/dt with c = 2 zeta sqrt(k m), m = k dt_ref^2/s <= m_red; eq. (14).
  KOKKOS_INLINE_FUNCTION double dampingOf(const Interaction& now) const {
    const double c = 2 * config.damping * now.stiffness * now.fade_weight * config.reference_step /
                     std::sqrt(config.penalty);
    return c * now.closing / dt;
  }

  KOKKOS_INLINE_FUNCTION void applyFriction(const Interaction& now, const FaceContact& contact,
                                            const Vec3& motion, FrictionSpring& friction,
                                            ContactSums& sums) const {
    friction.stiffness = config.friction_stiffness * now.stiffness;
    if (!(now.depth > 0 && friction.stiffness > 0) || now.is_retained)
      return; // nearly parallel edges could not balance the couple of a force across both
    kinematics.setLevers(faces, now, contact.depth, friction.lever);
    friction.motion = tangentialPart(slipOf(friction, motion, now, contact.face), now.normal);
    Vec3 rotated;
    if (isPersistent(contact)) {
      const FrictionSpring& last = previous.friction(contact.previous);
      rotated = rotateToPlane(last.force, now.normal);
      if (friction.stiffness < last.stiffness) // at equal stored energy
        rotated = std::sqrt(friction.stiffness / last.stiffness) * rotated;
    }
    friction.trial = rotated - friction.stiffness * friction.motion;
    friction.force = returnMap(friction.trial, config.friction * (now.force + now.damping));
    sums.terms.add(friction_stored, 0.5 * dot(rotated, friction.force) / friction.stiffness,
                   energy_scale);
  }

  // Motion that the friction force works on: that of the node, and the normal motion of the face's
  // corners, which the balancing forces work on; eq. (23).
  KOKKOS_INLINE_FUNCTION Vec3 slipOf(const FrictionSpring& friction, const Vec3& motion,
                                     const Interaction& pair, int face) const {
    double slope[2];
    kinematics.normalMotionGradient(faces, pair, face, slope);
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

  // Approach over the kick: half of the motions before and after the last forces.
  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION Real kickClosing(const Real& before, const Real& now) const {
    return 0.5 * (previous_dt + dt) * 0.5 * (before / previous_dt + now / dt);
  }

  // Records the work of the last step's forces over the half steps before and after them; this
  // step's motion is the second of these. Returns the work done on the contact's spring, dt F n .
  // (v^{n-1/2} + v^{n+1/2})/2, with its fading part. `closing_now` is the approach of this step
  // along the last normal.
  KOKKOS_INLINE_FUNCTION double recordWork(const PersistentContact& persistent, double closing_now,
                                           ContactSums& sums) const {
    const int index = persistent.previous, last_face = persistent.face;
    const Interaction& last = previous.interactions(index);
    const Vec3& motion = persistent.last_motion;
    const double kick = 0.5 * (previous_dt + dt);
    const double closing = kickClosing(last.closing, closing_now);
    double on_spring = last.force * closing;
    if (last.fade_weight < 1) {
      const FadingForce& fading = previous.fading(index);
      on_spring -=
          kick * 0.5 * (fading.work / previous_dt + workOf(fading, motion, last, last_face) / dt);
    }
    if (Kinematics::records_spring_work)
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

  KOKKOS_INLINE_FUNCTION void count(ContactSums& sums, const Interaction& now,
                                    const FaceContact& contact) const {
    ++sums.interactions;
    sums.active += now.depth > 0;
    if (now.depth > 0) {
      sums.max_penetration = maxOf(sums.max_penetration, kinematics.relativeDepth(faces, contact));
      sums.deepest = maxOf(sums.deepest, contact.depth);
    }
  }
  // k w p^n p^{n+1}/2, eq. (16), with the sum of w^n and w^{n+1} as `fade_weights`.
  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION static Real
  storedWithoutFading(const Real& last_stiffness, const Real& stiffness, const Real& fade_weights,
                      const Real& last_depth, const Real& depth) {
    return 0.25 * squareRoot(last_stiffness * stiffness) * fade_weights * last_depth * depth;
  }
  // Energy at the half step: (U^n + U^{n+1})/2 - (W^n - W^{n+1})/4, eq. (27), with U = k w p^2/2
  // and W^n the work of the forces of x^n over the motion from x^n to x^{n+1}; without fading it is
  // k p^n p^{n+1}/2.
  KOKKOS_INLINE_FUNCTION double storedAtHalfStep(const Interaction& last, const Interaction& now,
                                                 const FaceContact& contact,
                                                 double fading_work) const {
    if ((last.fade_weight == 1 && now.fade_weight == 1) || last.face != now.face ||
        !(last.depth > 0 && now.depth > 0))
      return storedWithoutFading(last.stiffness, now.stiffness, last.fade_weight + now.fade_weight,
                                 last.depth, now.depth);
    const double stiffness = std::sqrt(last.stiffness * now.stiffness);
    const Vec3 motion = faces.relativeMotion(last.point, contact.face, last.weight);
    double last_work = -last.first_force * -dot(last.normal, motion);
    if (last.fade_weight < 1) { // before its correction, as the other forces in this function
      const FadingForce& fading = previous.fading(contact.previous);
      if (fading.factor > 0)
        last_work += workOf(fading, motion, last, contact.face) / fading.factor;
    }
    const double work = fading_work - now.first_force * now.closing;
    return 0.25 * stiffness *
               (last.fade_weight * last.depth * last.depth +
                now.fade_weight * now.depth * now.depth) -
           0.25 * (last_work - work);
  }
};

} // namespace brickwall::contact
