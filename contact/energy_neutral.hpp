// First and last steps of a contact made neutral in energy: steps 5 to 7 of shared/contact_energy.md, point-wise.
// The work of a force F' on the pair in this step is F' (d- + d+')/2 = -F' (D + F' tau/2).
#pragma once

#include "contact/contact_history.hpp"

namespace brickwall::contact {

// The force, in [0, ...), at which the contact gives back exactly `energy`: the root of D F + tau F^2/2 = energy.
KOKKOS_INLINE_FUNCTION double forceThatReturns(double energy, double D, double tau) {
  return (-D + std::sqrt(D * D + 2 * energy * tau)) / tau;
}

// The corrected force of a contact whose pair closes by `next_closing` (d+, length) in the next step if the present
// forces act.
KOKKOS_INLINE_FUNCTION double neutralForce(const Interaction& pair, double next_closing) {
  const double tau = pair.mobility, present = pair.force, first = pair.first_force;
  if (!(tau > 0) || !(first > 0)) // both sides prescribed, or no load
    return first;
  const double D = -0.5 * (pair.closing + next_closing + present * tau);
  const double energy = maxOf(pair.stored, 0.0);
  double force = first;
  const bool is_last = pair.depth + next_closing + (present - first) * tau <= 0;
  if (is_last) {
    force = pair.stored > 0 ? minOf(forceThatReturns(energy, D, tau), 4 * first) : 0.0;
    force = maxOf(force, 0.0);
  } else if (pair.is_new) {
    force = present;
    for (int sweep = 0; sweep < 3; ++sweep) {
      const double closing = next_closing + (present - force) * tau;
      const double both = pair.closing + closing;
      if (!(both > 0))
        break;
      const double wanted =
          (pair.stiffness * pair.depth * (pair.depth + closing) - 2 * pair.stored) / both;
      force = minOf(maxOf(wanted, 0.0), first);
    }
  }
  if (D + 0.5 * force * tau > 0)
    force = minOf(force, forceThatReturns(energy, D, tau));
  return force;
}

} // namespace brickwall::contact
