// What contact enforcement counts and sums over its interactions.
#pragma once

#include "contact/base/fixed_point.hpp"

#include <mpi.h>

#include <string>

namespace brickwall::contact {

// Energies of contact: those in springs, at the half step n+1/2; works on the bodies, of the forces of step n.
enum ContactTerm : int {
  // sum of k p^n p^{n+1}/2, beyond edges as storedBetween(), in the second step of a contact as toBeReturned(): the contact term of
  // the half-step energy gauge
  spring_stored,
  friction_stored, // sum of t^n . t^{n+1}/(2 k_t)
  spring_work, // of edges only
  damping_work,
  friction_work,
  num_contact_terms
};

// This rank's sums over its interactions; sumOverRanks adds those of all ranks.
struct ContactSums {
  LimbSums<num_contact_terms> terms;
  std::int64_t touching =
      0; // nodes (or edges) inside a body, with or without a force, for each body
  std::int64_t interactions = 0; // those that are remembered: under load
  std::int64_t active = 0; // interactions with a force
  // Loaded interactions whose face is no longer a candidate: deeper than the search reaches.
  std::int64_t lost = 0;
  std::int64_t overflow = 0; // interactions beyond max_interactions of a node
  std::int64_t invalid = 0; // forces that are not finite or too large for the quantum
  double max_penetration = 0; // largest penetration with a force / sqrt(face area)
  double deepest = 0; // the same as a length

  KOKKOS_INLINE_FUNCTION ContactSums& operator+=(const ContactSums& b) {
    terms += b.terms;
    touching += b.touching;
    interactions += b.interactions;
    active += b.active;
    lost += b.lost;
    overflow += b.overflow;
    invalid += b.invalid;
    max_penetration = maxOf(max_penetration, b.max_penetration);
    deepest = maxOf(deepest, b.deepest);
    return *this;
  }
  // What a run must not go on with, in words; empty if nothing.
  std::string problem() const;
  // Of these, those that make the step's forces wrong; lost contacts are not among them, a run may go on with a warning.
  std::int64_t failures() const { return overflow + invalid + terms.invalid; }
};
// Collective.
void sumOverRanks(MPI_Comm comm, ContactSums& sums);

} // namespace brickwall::contact
