// Counts, energies and works of contact enforcement, summed over interactions.
#pragma once

#include "contact/base/fixed_point.hpp"

#include <mpi.h>

#include <cstdint>
#include <string>

namespace brickwall::contact {

// Stored energies are those at the half step n+1/2; works are those of the forces of step n on the
// bodies.
enum ContactTerm : int {
  // Contact term of the half-step energy: sum of k p^n p^{n+1}/2, eq. (16), or of eq. (27) where
  // contacts fade. In the second step of an energy-neutral contact, see ContactLaw::followEnergy().
  spring_stored,
  friction_stored, // sum of t^n . t^{n+1}/(2 k_t)
  spring_work, // edge-to-edge contact only
  damping_work,
  friction_work,
  num_contact_terms
};

// This rank's sums over its interactions; sumOverRanks() adds those of all ranks.
struct ContactSums {
  static constexpr int num_maxima = 2; // max_penetration and deepest, see LateSum
  LimbSums<num_contact_terms> terms;
  // pairs of a node (or edge) and a side that it penetrates, loaded or not
  std::int64_t penetrating = 0;
  std::int64_t interactions = 0; // interactions in the contact history: those under load
  std::int64_t active = 0; // interactions with p > 0
  // Loaded interactions whose face is no longer a candidate, since they are deeper than the search
  // reaches, or retained (ContactTest::retain) farther beyond a bent edge than it reaches.
  std::int64_t lost = 0;
  std::int64_t workspace = 0; // places that this rank's crowded rows take in the RowWorkspace
  std::int64_t tested = 0; // places that this rank's pairs take in the TestedPairs
  std::int64_t invalid = 0; // forces that are not finite or exceed the fixed-point range
  double max_penetration = 0; // largest penetration of a loaded contact over the size of its face
  double deepest = 0; // largest penetration of a loaded contact, length

  KOKKOS_INLINE_FUNCTION ContactSums& operator+=(const ContactSums& b) {
    terms += b.terms;
    penetrating += b.penetrating;
    interactions += b.interactions;
    active += b.active;
    lost += b.lost;
    workspace += b.workspace;
    tested += b.tested;
    invalid += b.invalid;
    max_penetration = maxOf(max_penetration, b.max_penetration);
    deepest = maxOf(deepest, b.deepest);
    return *this;
  }
  // Message that describes why a run must not continue; empty if it may.
  std::string problem() const;
  // Number of failures that make the forces of the step wrong. Lost contacts are not among them; a
  // run may continue with a warning.
  std::int64_t failures() const { return invalid + terms.invalid; }
};
// Collective.
void sumOverRanks(MPI_Comm comm, ContactSums& sums);

} // namespace brickwall::contact
