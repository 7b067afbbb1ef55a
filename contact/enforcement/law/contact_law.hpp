// The contact law of one contact in one step: activation and continuation, stiffness, spring and
// damping forces before the energy-neutral correction, and energies; eqs. (9), (10), (13), (14),
// (16) and (20) of theory.md. Functions of a scalar type Real: one contact, or one in each SIMD
// lane, with the same bits.
#pragma once

#include "contact/enforcement/law/contact_state.hpp"
#include "contact/enforcement/law/enforcement_config.hpp"

namespace brickwall::contact {

struct ContactLaw {
  // With at least this friction, a sliding contact that returns to its node within so many steps
  // settles: it has at most this penalty and at least this damping ratio; eq. (41).
  static constexpr double settling_friction = 1e-6;
  static constexpr int settling_steps = 100;
  static constexpr double settling_penalty = 0.2, settling_damping = 1;

  EnforcementConfig config;
  double dt = 0, previous_dt = 0; // of this step and of the last one, time

  // Approach over the kick: half of the motions before and after the last forces.
  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION Real kickClosing(const Real& before, const Real& now) const {
    return 0.5 * (previous_dt + dt) * 0.5 * (before / previous_dt + now / dt);
  }

  // The spring: offset, stiffness (at most `cap` for a persistent contact) and force.
  //
  // Activation, eq. (9): the part of the penetration that this step's motion did not cause becomes
  // the offset e, so that no energy is created. An initial overlap, which is an activation at rest,
  // gives no force.
  //
  // Continuation: when the contact moves to another face, the deformation p continues with the
  // approach of this step. Then e may be negative, and the energy stored beyond P is returned in
  // the last step before the node is in front of the face.
  template <class Real>
  KOKKOS_INLINE_FUNCTION void setSpring(ContactState<Real>& state, const Real& cap) const {
    const Real none = 0.0, penetration = state.penetration;
    const Real closing = -dot(Triple<Real>(state.normal), Triple<Real>(state.motion));
    const auto persists = !(Real(state.is_persistent) == none);
    const Real continued_depth =
        maxOf(Real(state.last_depth) + Real(state.closing_at_last_point), none);
    Real stiffness = state.last_stiffness;
    Real offset = where(!(Real(state.has_changed_face) == none),
                        penetration - continued_depth * Real(state.depth_factor),
                        minOf(Real(state.last_offset), penetration));
    soften(cap, penetration, stiffness, offset);
    const Real by_motion = minOf(penetration, maxOf(none, closing));
    state.closing = closing;
    state.stored = where(persists, Real(state.last_stored) + Real(state.contact_work), none);
    state.stiffness = where(persists, stiffness, Real(state.activation_stiffness));
    state.fade_weight = Real(state.last_fade_weight);
    state.first_damping = none;
    setOffset(state, where(persists, offset, penetration - by_motion));
  }
  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION static void setOffset(ContactState<Real>& state, const Real& offset) {
    const Real depth = Real(state.penetration) - offset;
    state.offset = offset;
    state.depth = depth;
    state.first_force = Real(state.stiffness) * depth;
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

  // c d-/dt with c = 2 zeta sqrt(k m), m = k dt_ref^2/s <= m_red, and F + F_d >= 0; eq. (14).
  template <class Real>
  KOKKOS_INLINE_FUNCTION void setDamping(ContactState<Real>& state) const {
    if (!(config.damping > 0))
      return;
    const Real c = dampingRate(config.damping, config.penalty) * Real(state.stiffness) *
                   Real(state.fade_weight);
    const Real damping = maxOf(c * Real(state.closing) / dt, -Real(state.first_force));
    state.first_damping = where(Real(state.depth) > Real(0.0), damping, Real(0.0));
  }
  // c/k at w = 1, time.
  KOKKOS_INLINE_FUNCTION double dampingRate(double ratio, double penalty) const {
    return 2 * ratio * config.reference_step / std::sqrt(penalty);
  }

  // Contacts settle by the corrections of the energy-neutral scheme only.
  KOKKOS_INLINE_FUNCTION bool maySettle() const {
    return config.friction >= settling_friction && config.scheme == Scheme::energy_neutral;
  }
  // s' and c/k of a contact that settles; eq. (41).
  KOKKOS_INLINE_FUNCTION double settlingPenalty() const {
    return minOf(config.penalty, +settling_penalty);
  }
  double settlingRate() const {
    return dampingRate(maxOf(config.damping, +settling_damping), settlingPenalty());
  }

  // k w p^n p^{n+1}/2, with the mean of w^n and w^{n+1}; eq. (16).
  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION static Real springEnergy(const ContactState<Real>& state) {
    return 0.25 * squareRoot(Real(state.last_stiffness) * Real(state.stiffness)) *
           (Real(state.last_fade_weight) + Real(state.fade_weight)) * Real(state.last_depth) *
           Real(state.depth);
  }

  // The energies of a persistent contact, from state.spring_energy, and the offset that follows.
  template <class Real>
  KOKKOS_INLINE_FUNCTION void followEnergy(ContactState<Real>& state) const {
    const Real energy = state.spring_energy;
    if (config.scheme != Scheme::energy_neutral) {
      state.recoverable = energy;
      return;
    }
    // Energy to record for a contact in its second step. Its first force was corrected, to zero if
    // the end of the contact was in sight, and so will be that of this step. If the contact ends
    // with this step, it returns the work done on it, and not the energy that the uncorrected
    // spring would hold. From the next step on the energy is that of the spring.
    state.recoverable = where(!(Real(state.was_new) == Real(0.0)),
                              minOf(energy, maxOf(Real(state.stored), Real(0.0))), energy);
    const auto persists = !(Real(state.is_persistent) == Real(0.0));
    state.offset = where(persists, adjustedOffset(state), Real(state.offset));
  }
  // Where normals rotate and faces change, the energy of the spring drifts from the work that was
  // done on it, by more than the last step can return. Half of the difference is made up from the
  // next step on by changing e; eq. (20).
  template <class Real>
  KOKKOS_INLINE_FUNCTION static Real adjustedOffset(const ContactState<Real>& state) {
    constexpr double noise = 1e-9, max_share = 0.1; // relative to the energy, and to p
    const Real depth = state.depth, weight = state.fade_weight, stored = state.stored;
    const Real deficit = stored - Real(state.spring_energy);
    const auto follows =
        (weight * depth > Real(0.0)) & (magnitude(deficit) > noise * magnitude(stored));
    const Real by_energy = deficit / (Real(state.stiffness) * weight * depth);
    // A contact that fades does not get p > P by it: p would grow without bound as w vanishes.
    const Real limit = max_share * depth, offset = state.offset;
    const Real most = where(weight < Real(1.0), minOf(limit, maxOf(offset, Real(0.0))), limit);
    const Real change = minOf(maxOf(by_energy, -limit), most);
    return where(follows, offset - change, offset);
  }
};

} // namespace brickwall::contact
