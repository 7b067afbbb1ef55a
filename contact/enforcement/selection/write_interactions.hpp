// Applies the contact law to the contacts that several rows have selected, and writes their
// interactions and forces. Contacts with a normal spring and damping only are computed in SIMD
// lanes; contacts with friction, and those that fade out beyond an edge, one by one, as all are
// where there are no lanes. Kernel part of SelectInteractions.
#pragma once

#include "contact/enforcement/law/energy_neutral.hpp"
#include "contact/enforcement/selection/enforcement_step.hpp"

namespace brickwall::contact {

// Below it a transfer to another face does not keep the energy.
constexpr double min_fade_weight = 0.01;

template <class Kinematics>
struct WriteInteractions {
  const EnforcementStep<Kinematics>& step;

  // Writes `count` contacts; those of a row follow each other.
  KOKKOS_INLINE_FUNCTION void writeAll(const FaceContact* contacts, int count,
                                       ContactSums& sums) const {
    constexpr int width = NumLanes<Lanes>::value;
    if (count == 0)
      return;
    const std::int64_t begin = step.reserveSlots(count);
    sums.interactions += count;
    if (!step.hasSlots(begin, count)) // the step is repeated with more memory
      return;
    for (int i = 0; i < count; ++i)
      step.next.interactions.prefetch(begin + i);
    int plain[width], num_plain = 0;
    for (int i = 0; i < count; ++i) {
      const int node = contacts[i].node;
      if (i == 0 || node != contacts[i - 1].node)
        step.next.row_begin(node) = static_cast<int>(begin) + i;
      if (fills_lanes && isPlain(contacts[i]))
        plain[num_plain++] = i;
      else
        writeOne(contacts[i], begin + i, sums);
      if (num_plain == width || (num_plain > 0 && i + 1 == count)) {
        writeLanes(contacts, plain, num_plain, begin, sums);
        num_plain = 0;
      }
    }
  }

  // Whether the contact has only a spring and damping along the normal.
  KOKKOS_FORCEINLINE_FUNCTION bool isPlain(const FaceContact& contact) const {
    return !(step.law.config.friction > 0) && !contact.releases &&
           !step.kinematics.mayFade(contact) &&
           !(contact.is_persistent &&
             (lastOf(contact).fade_weight < 1 || lastOf(contact).releases()));
  }
  // Writes a plain contact at `index`.
  KOKKOS_INLINE_FUNCTION void writePlain(const FaceContact& contact, std::int64_t index,
                                         ContactSums& sums) const {
    const int only = 0;
    writeLanes(&contact, &only, 1, index, sums);
  }
  // Writes any contact at `index`.
  KOKKOS_INLINE_FUNCTION void writeOne(const FaceContact& contact, std::int64_t index,
                                       ContactSums& sums) const {
    const ContactLaw& law = step.law;
    ContactState<double> state;
    gather(0, contact, state);
    if (state.has_changed_face[0] != 0) {
      const double weight =
          contact.releases ? 1 : step.kinematics.fadeWeightOf(step.faces, contact.node, contact);
      state.depth_factor[0] = std::sqrt(state.last_fade_weight[0] / maxOf(weight, min_fade_weight));
    }
    const double softer = softnessOf(contact);
    state.activation_stiffness[0] *= softer;
    law.setSpring(state, softer * cap(state));
    if (contact.is_persistent && state.last_fade_weight[0] < 1)
      limitStoredEnergy(contact, state);
    if (contact.releases && (state.last_fade_weight[0] < 1 || !(contact.depth > 0)))
      ContactLaw::setOffset(state, contact.depth - depthThatStores(state));
    Interaction local;
    Interaction& now = step.next.interactions.edit(index, local);
    writeIdentity(contact, now);
    state.write(0, now);
    FadingForce fading;
    if (contact.releases)
      now.fade_weight = 1;
    else
      step.kinematics.fade(law.config, step.faces, contact, now, fading);
    state.fade_weight = now.fade_weight;
    state.first_force = now.first_force;
    if (!contact.settles) // otherwise the corrections find it
      law.setDamping(state);
    if (now.fade_weight < 1)
      fading.work = step.workOf(fading, contact.motion, now, contact.face);
    count(contact, now.depth, sums);
    const bool releases = contact.releases && canRelease(state);
    if (contact.is_persistent) {
      state.spring_energy = storedAtHalfStep(lastOf(contact), now, contact, state, fading.work);
      law.followEnergy(state);
      const bool stores_rest = releases || lastOf(contact).releases();
      sums.terms.add(spring_stored, stores_rest ? state.stored[0] : state.recoverable[0],
                     step.energy_scale);
    }
    state.write(0, now);
    if (releases)
      now.offset = Interaction::releasing_offset;
    step.next.interactions.commit(index, now);
    if (now.fade_weight < 1)
      step.next.fading.store(index, fading);
    const int previous = contact.is_persistent ? contact.previous : -1;
    addForces(now, index, contact.depth, contact.motion, previous, fading, sums);
  }
  // Adds the forces of a contact whose normal ones are known, and applies friction. `previous`: in
  // the history, or -1.
  KOKKOS_INLINE_FUNCTION void addForces(const Interaction& now, std::int64_t index,
                                        double penetration, const Vec3& motion, int previous,
                                        const FadingForce& fading, ContactSums& sums) const {
    FrictionSpring friction;
    if (step.law.config.friction > 0) {
      applyFriction(now, penetration, motion, previous, friction, sums);
      step.next.friction.store(index, friction);
    }
    if (now.first_force == 0)
      return;
    PairQuanta<double> quanta;
    step.add.round(now, friction, fading, quanta);
    if (quanta.fits)
      step.add.add(now, quanta, 1);
    else
      ++sums.invalid;
  }

  // The contact law of plain contacts, and their forces in quanta.
  template <class Real>
  KOKKOS_INLINE_FUNCTION void apply(ContactState<Real>& state, const Real& share,
                                    const Real (&weights)[4], PairQuanta<Real>& quanta) const {
    const ContactLaw& law = step.law;
    law.setSpring(state, cap(state));
    law.setDamping(state);
    state.spring_energy = ContactLaw::springEnergy(state);
    law.followEnergy(state);
    step.add.round(Real(state.first_force) + Real(state.first_damping), Triple<Real>(state.normal),
                   share, weights, quanta);
  }
  // cap_factor of a persistent contact.
  KOKKOS_FORCEINLINE_FUNCTION double capFactor(int node, int face, double stiffness,
                                               double bound) const {
    return stiffness > bound ? step.kinematics.capFactor(node, face) : 1;
  }
  // Counts a contact under load.
  KOKKOS_FORCEINLINE_FUNCTION static void count(double penetration, double relative_depth,
                                                ContactSums& sums) {
    ++sums.active;
    sums.max_penetration = maxOf(sums.max_penetration, relative_depth);
    sums.deepest = maxOf(sums.deepest, penetration);
  }

private:
  // The deformation p at which the spring of a contact holds the energy that is left in it.
  KOKKOS_INLINE_FUNCTION static double depthThatStores(const ContactState<double>& state) {
    return std::sqrt(2 * maxOf(double(state.stored), 0.0) / state.stiffness);
  }
  // Whether about the largest force of a last step returns the energy of a contact. One that
  // approaches faster is kept meanwhile, since such a force would store more.
  KOKKOS_INLINE_FUNCTION bool canRelease(const ContactState<double>& state) const {
    const double closing = state.closing, stored = maxOf(double(state.stored), 0.0);
    const double mobility = step.law.dt * step.law.dt * state.inverse_mass;
    return closing <= 0 ||
           forceThatReturns(stored, -closing, mobility) <= 4 * double(state.first_force);
  }
  KOKKOS_FORCEINLINE_FUNCTION decltype(auto) lastOf(const FaceContact& contact) const {
    return step.previous.interactions(contact.previous);
  }
  // s'/s of a contact that settles, eq. (41); otherwise 1.
  KOKKOS_FORCEINLINE_FUNCTION double softnessOf(const FaceContact& contact) const {
    return contact.settles ? step.law.settlingPenalty() / step.law.config.penalty : 1;
  }

  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION void gather(int lane, const FaceContact& contact,
                                          ContactState<Real>& state) const {
    state.normal.set(lane, contact.unitNormal());
    state.motion.set(lane, contact.motion);
    state.penetration[lane] = contact.depth;
    state.inverse_mass[lane] = contact.inverse_mass;
    state.activation_stiffness[lane] = contact.activation_stiffness;
    state.cap_factor[lane] = 1;
    state.is_persistent[lane] = contact.is_persistent;
    state.contact_work[lane] = contact.contact_work;
    state.closing_at_last_point[lane] = contact.closing_at_last_point;
    state.depth_factor[lane] = 1;
    state.has_changed_face[lane] = 0;
    if (!contact.is_persistent)
      return state.recallNone(lane);
    const Interaction& last = lastOf(contact);
    state.recall(lane, last);
    state.has_changed_face[lane] = contact.hasChangedFace(last);
    state.cap_factor[lane] = capFactor(
        contact.node, contact.face, last.stiffness,
        softnessOf(contact) * step.kinematics.stiffnessCap(step.law.config, contact.inverse_mass));
  }
  template <class Real>
  KOKKOS_INLINE_FUNCTION Real cap(const ContactState<Real>& state) const {
    return Real(state.cap_factor) *
           step.kinematics.stiffnessCap(step.law.config, Real(state.inverse_mass));
  }
  KOKKOS_FORCEINLINE_FUNCTION void writeIdentity(const FaceContact& contact,
                                                 Interaction& now) const {
    now.side = step.kinematics.sideOf(step.faces, contact.face);
    now.face = step.kinematics.idOf(step.faces, contact.face);
    now.node = contact.node;
    now.point = contact.point;
    now.face_index = contact.face;
    now.is_retained = contact.is_retained;
    now.settles = contact.settles;
    now.normal = contact.unitNormal();
    for (int j = 0; j < 4; ++j)
      now.weight[j] = contact.weight[j];
  }
  KOKKOS_INLINE_FUNCTION void count(const FaceContact& contact, double depth,
                                    ContactSums& sums) const {
    if (depth > 0)
      count(contact.depth, step.kinematics.relativeDepth(step.faces, contact), sums);
  }

  KOKKOS_INLINE_FUNCTION void writeLanes(const FaceContact* contacts, const int* numbers,
                                         int num_lanes, std::int64_t begin,
                                         ContactSums& sums) const {
    constexpr int width = NumLanes<Lanes>::value;
    ContactState<Lanes> state;
    LaneArray<Lanes> share, weight[4];
    for (int lane = 0; lane < width; ++lane) {
      const FaceContact& contact = contacts[numbers[minOf(lane, num_lanes - 1)]];
      gather(lane, contact, state);
      share[lane] = contact.point.share;
      for (int j = 0; j < 4; ++j)
        weight[j][lane] = contact.weight[j];
    }
    PairQuanta<Lanes> quanta;
    const Lanes weights[4] = {weight[0], weight[1], weight[2], weight[3]};
    apply(state, Lanes(share), weights, quanta);
    LaneArray<Lanes> fits;
    fits = where(quanta.fits, Lanes(1.0), Lanes(0.0));
    for (int lane = 0; lane < num_lanes; ++lane) {
      const FaceContact& contact = contacts[numbers[lane]];
      Interaction local;
      Interaction& now = step.next.interactions.edit(begin + numbers[lane], local);
      writeIdentity(contact, now);
      state.write(lane, now);
      step.next.interactions.commit(begin + numbers[lane], now);
      count(contact, state.depth[lane], sums);
      if (contact.is_persistent)
        sums.terms.add(spring_stored, state.recoverable[lane], step.energy_scale);
      if (fits[lane] != 0)
        step.add.add(now, quanta, 1, lane);
      else
        ++sums.invalid;
    }
  }

  // A contact that was about to end beyond an edge has returned its energy. If it loads again and
  // its spring would hold more than largest_gain times the work done on it, it stores that work,
  // with the energy k w p^n p^{n+1}/2 at the half step.
  static constexpr double largest_gain = 2;
  KOKKOS_INLINE_FUNCTION void limitStoredEnergy(const FaceContact& contact,
                                                ContactState<double>& state) const {
    const double depth = state.depth, stored = maxOf(double(state.stored), 0.0);
    const double fade_weight =
        0.5 *
        (state.last_fade_weight + step.kinematics.fadeWeightOf(step.faces, contact.node, contact));
    const double softened = state.stiffness * fade_weight, last_depth = state.last_depth;
    if (depth > 0 && softened * last_depth * depth > 2 * largest_gain * stored)
      ContactLaw::setOffset(state, contact.depth - 2 * stored / (softened * last_depth));
  }
  // Energy at the half step: (U^n + U^{n+1})/2 - (W^n - W^{n+1})/4, eq. (27), with U = k w p^2/2
  // and W^n the work of the forces of x^n over the motion from x^n to x^{n+1}; without fading it is
  // k p^n p^{n+1}/2.
  KOKKOS_INLINE_FUNCTION double storedAtHalfStep(const Interaction& last, const Interaction& now,
                                                 const FaceContact& contact,
                                                 const ContactState<double>& state,
                                                 double fading_work) const {
    if ((last.fade_weight == 1 && now.fade_weight == 1) || contact.face != contact.previous_face ||
        !(last.depth > 0 && now.depth > 0))
      return ContactLaw::springEnergy(state);
    const double stiffness = std::sqrt(last.stiffness * now.stiffness);
    const Vec3 motion = step.faces.relativeMotion(last.point, contact.face, last.weight);
    double last_work = -last.first_force * -dot(last.normal, motion);
    if (last.fade_weight < 1) { // before its correction, as the other forces in this function
      const FadingForce& fading = step.previous.fading(contact.previous);
      if (fading.factor > 0)
        last_work += step.workOf(fading, motion, last, contact.face) / fading.factor;
    }
    const double work = fading_work - now.first_force * now.closing;
    return 0.25 * stiffness *
               (last.fade_weight * last.depth * last.depth +
                now.fade_weight * now.depth * now.depth) -
           0.25 * (last_work - work);
  }

  KOKKOS_INLINE_FUNCTION void applyFriction(const Interaction& now, double penetration,
                                            const Vec3& motion, int previous,
                                            FrictionSpring& friction, ContactSums& sums) const {
    friction.stiffness = step.law.config.friction_stiffness * now.stiffness;
    if (!(now.depth > 0 && friction.stiffness > 0) || now.is_retained)
      return; // nearly parallel edges could not balance the couple of a force across both
    Vec3 tangent[2], tangent_motion[2];
    step.kinematics.findTangents(step.faces, now, now.face_index, tangent, tangent_motion);
    dualBasis(tangent, penetration, friction.lever);
    friction.motion =
        tangentialPart(slipOf(friction, motion, now.normal, tangent_motion), now.normal);
    const double half_turn = halfTurnOf(tangent, tangent_motion, now.normal);
    Vec3 rotated;
    if (previous >= 0) {
      const FrictionSpring& last = step.previous.friction(previous);
      rotated = turnInPlane(rotateToPlane(last.force, now.normal), now.normal, half_turn);
      if (friction.stiffness < last.stiffness) // at equal stored energy
        rotated = std::sqrt(friction.stiffness / last.stiffness) * rotated;
    }
    friction.trial =
        trialForce(rotated, friction.stiffness, friction.motion, now.normal, half_turn);
    friction.force =
        returnMap(friction.trial, step.law.config.friction * (now.force + now.damping));
    sums.terms.add(friction_stored, 0.5 * dot(rotated, friction.force) / friction.stiffness,
                   step.energy_scale);
  }
};

} // namespace brickwall::contact
