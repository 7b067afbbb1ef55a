// Energy-neutral first and last steps of a contact, eqs. (15) to (19) and (28) of theory.md. With a
// plain spring F = k p the work over the life of a contact telescopes to -k/2 (p^N p^{N+1} - p^0
// p^{-1}): only its first and its last step err, so these two are corrected. Point-wise.
//
// d- and d+ are the approaches at the velocities before and after the kick, over its length dt. A
// force F' does the work F' (d- + d+')/2 = -F' (D + F' tau/2) on the pair; eq. (17).
#pragma once

#include "contact/base/pack.hpp"
#include "contact/enforcement/law/contact_history.hpp"

namespace brickwall::contact {

// Motion of a pair around a kick of length dt.
template <class Real>
struct KickedPairOf {
  Real closing; // d-, length
  Real next_closing; // d+, length, with the present forces
  Real next_drift; // length of the next drift, in units of dt
  Real mobility; // tau = dt^2 (1/m_s + sum N_j^2/m_j), length/force
};
using KickedPair = KickedPairOf<double>;

// The members of an interaction that the correction reads, by the same names.
template <class Real>
struct SpringState {
  Real force, first_force, depth, offset, stored;
  typename MaskOf<Real>::type is_new;
};
KOKKOS_INLINE_FUNCTION SpringState<double> springOf(const Interaction& pair) {
  return {pair.force, pair.first_force, pair.depth, pair.offset, pair.stored, pair.is_new != 0};
}

// The force F >= 0 at which the contact returns exactly `energy`: the root of D F + tau F^2/2 =
// energy; eq. (19).
template <class Real>
KOKKOS_INLINE_FUNCTION Real forceThatReturns(const Real& energy, const Real& D, const Real& tau) {
  return (-D + squareRoot(D * D + 2 * energy * tau)) / tau;
}

// Whether a contact ends in the next drift, of the relative length `next_drift`, in which the pair
// approaches by `closing` a kick: p = 0 or P = 0, whichever is first.
template <class Real>
KOKKOS_INLINE_FUNCTION typename MaskOf<Real>::type
endsBy(const SpringState<Real>& pair, const Real& next_drift, const Real& closing) {
  return minOf(pair.depth, pair.depth + pair.offset) + next_drift * closing <= Real(0.0);
}

// Corrected normal forces, of one contact or of as many as there are lanes; eqs. (18) and (19).
template <class Real>
KOKKOS_INLINE_FUNCTION Real neutralForce(const SpringState<Real>& pair,
                                         const KickedPairOf<Real>& motion) {
  using Mask = typename MaskOf<Real>::type;
  const Real none = 0.0;
  const Real tau = motion.mobility, present = pair.force, first = pair.first_force;
  // motion prescribed on both sides, or no load
  const Mask is_fixed = !((tau > none) & (first > none));
  const Real D = -0.5 * (motion.closing + motion.next_closing + present * tau);
  const Real returning = forceThatReturns(maxOf(pair.stored, none), D, tau);
  const Real last = minOf(returning, 4 * first);
  const auto endsWith = [&](const Real& force) {
    return endsBy(pair, motion.next_drift, Real(motion.next_closing + (present - force) * tau));
  };
  const Mask ends_by_first = endsWith(first);
  const Mask is_old = !pair.is_new, is_loaded = !is_fixed;
  const Mask is_last = is_old & ends_by_first & endsWith(last), goes_on = !is_last;
  const Mask stores = is_loaded & (pair.is_new | (ends_by_first & goes_on));
  Real force = where(is_last, last, first);
  if (isAny(stores)) { // k w p p+/2 in total
    const Real free_closing = motion.next_closing + present * tau; // without a force
    const Real B = motion.closing + free_closing + motion.next_drift * first * tau;
    const Real C = first * (pair.depth + motion.next_drift * free_closing) - 2 * pair.stored;
    const Real denominator = B + squareRoot(maxOf(B * B - 4 * tau * C, none));
    const Real storing = minOf(maxOf(2 * C / denominator, none), first);
    force = where(stores, where(denominator > none, storing, none), force);
  }
  // A contact never returns more than is stored.
  force = where(D + 0.5 * force * tau > none, minOf(force, returning), force);
  return where(is_fixed, first, force);
}

// The damping force that is `rate` (force/length) times the mean approach over the kick, which it
// changes; eq. (41). `motion.next_closing` belongs to `present`, the damping force so far.
KOKKOS_INLINE_FUNCTION double meanDamping(double present, double rate, const KickedPair& motion) {
  const double missing = 0.5 * rate * (motion.closing + motion.next_closing) - present;
  return present + missing / (1 + 0.5 * rate * motion.mobility);
}

// Work of the fading force on the pair over the length of a kick: `before` and `after` at the
// velocities before and after the kick; `gain` is the part of `after` that the force itself causes.
struct KickedFading {
  double before, after, gain; // energy
  double next_drift; // length of the next drift, in units of dt
};

// Factor of the fading force, eq. (28). In the last step, after which w = 0, the fading force
// returns what is stored beyond the energy that the normal force returns; in earlier steps at most
// that. `force` is the corrected normal force, and `motion.next_closing` belongs to it.
KOKKOS_INLINE_FUNCTION double neutralFading(const Interaction& pair, double force,
                                            const KickedPair& motion, const KickedFading& fading,
                                            double work_to_end) {
  if (!(fading.gain > 0))
    return 1;
  const double by_normal = -0.5 * force * (motion.closing + motion.next_closing);
  const double remaining = pair.stored - by_normal;
  const double linear = 0.5 * (fading.before + fading.after - fading.gain);
  const double full_release =
      remaining > 0
          ? (-linear + std::sqrt(linear * linear + 2 * fading.gain * remaining)) / fading.gain
          : 0.0;
  // A reserve, since w falls faster where the depth changes or the face rotates.
  const bool is_last = fading.after * fading.next_drift >= 0.6 * work_to_end;
  const bool releases = linear + 0.5 * fading.gain > 0;
  return is_last ? full_release : releases ? minOf(1.0, full_release) : 1.0;
}

} // namespace brickwall::contact
