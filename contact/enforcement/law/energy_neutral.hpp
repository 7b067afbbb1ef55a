// First and last steps of a contact made neutral in energy. With a plain spring F = k p the work of an episode telescopes to
// -k/2 (p^N p^{N+1} - p^0 p^{-1}): only its first and its last step err, so these two are weighted. Point-wise.
//
// d- and d+ are the closing motions at the speeds before and after the kick, over its length dt; the work of a force F' on the
// pair is then F' (d- + d+')/2 = -F' (D + F' tau/2).
#pragma once

#include "contact/base/pack.hpp"
#include "contact/enforcement/law/contact_history.hpp"

namespace brickwall::contact {

// Motion of a pair around a kick of length dt.
template <class Real>
struct KickedPairOf {
  Real closing; // d-
  Real next_closing; // d+, if the present forces act
  Real next_drift; // length of the drift to come, of dt
  Real mobility; // tau = dt^2 (1/m_s + sum N_j^2/m_j), length/force
};
using KickedPair = KickedPairOf<double>;

// What is asked of an interaction, by the names of its members.
template <class Real>
struct SpringState {
  Real force, first_force, depth, offset, stored;
  typename MaskOf<Real>::type is_new;
};
KOKKOS_INLINE_FUNCTION SpringState<double> springOf(const Interaction& pair) {
  return {pair.force, pair.first_force, pair.depth, pair.offset, pair.stored, pair.is_new != 0};
}

// The force, in [0, ...), at which the contact gives back exactly `energy`: the root of D F + tau F^2/2 = energy.
template <class Real>
KOKKOS_INLINE_FUNCTION Real forceThatReturns(const Real& energy, const Real& D, const Real& tau) {
  return (-D + squareRoot(D * D + 2 * energy * tau)) / tau;
}

// The corrected forces of contacts, one or as many as there are lanes.
template <class Real>
KOKKOS_INLINE_FUNCTION Real neutralForce(const SpringState<Real>& pair,
                                         const KickedPairOf<Real>& motion) {
  using Mask = typename MaskOf<Real>::type;
  const Real none = 0.0;
  const Real tau = motion.mobility, present = pair.force, first = pair.first_force;
  const Mask is_fixed = !((tau > none) & (first > none)); // both sides prescribed, or no load
  const Real D = -0.5 * (motion.closing + motion.next_closing + present * tau);
  const Real returning = forceThatReturns(maxOf(pair.stored, none), D, tau);
  const Real closing_by_first = motion.next_closing + (present - first) * tau;
  const Real way_out = minOf(pair.depth, pair.depth + pair.offset); // the spring's end, or the face
  const Mask is_last = way_out + motion.next_drift * closing_by_first <= none;
  Real force = first;
  Mask is_open = pair.is_new & !is_last & !is_fixed; // stores k w p p+/2 in all
  force = where(is_open, present, force);
  for (int sweep = 0; sweep < 3 && isAny(is_open); ++sweep) {
    const Real closing = motion.next_closing + (present - force) * tau;
    const Real both = motion.closing + closing;
    is_open = is_open & (both > none);
    const Real next_depth = pair.depth + motion.next_drift * closing;
    const Real wanted = (first * next_depth - 2 * pair.stored) / both;
    force = where(is_open, minOf(maxOf(wanted, none), first), force);
  }
  // In the last step it gives back all that is stored.
  const Real last = maxOf(where(pair.stored > none, minOf(returning, 4 * first), none), none);
  force = where(is_last, last, force);
  // Never does it give back more than is stored.
  force = where(D + 0.5 * force * tau > none, minOf(force, returning), force);
  return where(is_fixed, first, force);
}

// A contact that fades out beyond an edge, with the work of its fading force on the pair: `before` and `after` over the kick's
// length at the speeds before and after the kick, and `gain`, by how much the force itself raises the second.
struct KickedFading {
  double before, after, gain; // energy
  double next_drift; // length of the drift to come, of dt
};

// By how much to multiply the fading force. In the last step, after which w = 0, it gives back what is stored beyond what the
// normal force gives back; before, no more than that.
// `force`: the normal one, corrected; `motion.next_closing` goes with it.
KOKKOS_INLINE_FUNCTION double neutralFading(const Interaction& pair, double force,
                                            const KickedPair& motion, const KickedFading& fading,
                                            double work_to_end) {
  if (!(fading.gain > 0))
    return 1;
  const double by_normal = -0.5 * force * (motion.closing + motion.next_closing);
  const double left = pair.stored - by_normal;
  const double linear = 0.5 * (fading.before + fading.after - fading.gain);
  const double all =
      left > 0 ? (-linear + std::sqrt(linear * linear + 2 * fading.gain * left)) / fading.gain
               : 0.0;
  // With some reserve, for w falls faster where the depth or the face turns.
  const bool is_last = fading.after * fading.next_drift >= 0.6 * work_to_end;
  const bool gives = linear + 0.5 * fading.gain > 0;
  return is_last ? all : gives ? minOf(1.0, all) : 1.0;
}

} // namespace brickwall::contact
