// First and last steps of a contact made neutral in energy. With a plain spring F = k p the work of an episode telescopes to
// -k/2 (p^N p^{N+1} - p^0 p^{-1}): only its first and its last step err, so these two are weighted. Point-wise.
//
// d- and d+ are the closing motions at the speeds before and after the kick, over its length dt; the work of a force F' on the
// pair is then F' (d- + d+')/2 = -F' (D + F' tau/2).
#pragma once

#include "contact/contact_history.hpp"

namespace brickwall::contact {

// Motion of a pair around a kick of length dt.
struct KickedPair {
  double closing; // d-
  double next_closing; // d+, if the present forces act
  double next_drift; // length of the drift to come, of dt
  double mobility; // tau = dt^2 (1/m_s + sum N_j^2/m_j), length/force
};

// The force, in [0, ...), at which the contact gives back exactly `energy`: the root of D F + tau F^2/2 = energy.
KOKKOS_INLINE_FUNCTION double forceThatReturns(double energy, double D, double tau) {
  return (-D + std::sqrt(D * D + 2 * energy * tau)) / tau;
}

// The corrected force of a contact.
KOKKOS_INLINE_FUNCTION double neutralForce(const Interaction& pair, const KickedPair& motion) {
  const double tau = motion.mobility, present = pair.force, first = pair.first_force;
  if (!(tau > 0) || !(first > 0)) // both sides prescribed, or no load
    return first;
  const double D = -0.5 * (motion.closing + motion.next_closing + present * tau);
  const double energy = maxOf(pair.stored, 0.0);
  double force = first;
  const double closing_by_first = motion.next_closing + (present - first) * tau;
  const double way_out =
      minOf(pair.depth, pair.depth + pair.offset); // the spring's end, or the face
  const bool is_last = way_out + motion.next_drift * closing_by_first <= 0;
  if (is_last) { // gives back all that is stored
    force = pair.stored > 0 ? minOf(forceThatReturns(energy, D, tau), 4 * first) : 0.0;
    force = maxOf(force, 0.0);
  } else if (pair.is_new) { // stores k w p p+/2 in all
    force = present;
    for (int sweep = 0; sweep < 3; ++sweep) {
      const double closing = motion.next_closing + (present - force) * tau;
      const double both = motion.closing + closing;
      if (!(both > 0))
        break;
      const double next_depth = pair.depth + motion.next_drift * closing;
      const double wanted = (first * next_depth - 2 * pair.stored) / both;
      force = minOf(maxOf(wanted, 0.0), first);
    }
  }
  if (D + 0.5 * force * tau > 0) // never gives back more than is stored
    force = minOf(force, forceThatReturns(energy, D, tau));
  return force;
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
