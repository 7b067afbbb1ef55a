// Exact sums of the ledger of energy and momentum: their terms, their scales, and those of a state
// of motion. The kick (central_difference.hpp) computes its own sums.
#pragma once

#include "contact/base/fixed_point.hpp"
#include "contact/base/vec3.hpp"
#include "mechanics/force/internal_force.hpp"
#include "mechanics/mesh/nodal_state.hpp"

#include <mpi.h>

namespace brickwall::mechanics {

// Scales of the exact sums, from input data only and therefore equal on every rank.
struct LedgerScales {
  LimbScale energy; // energies and works
  LimbScale power; // f . v
  LimbScale momentum; // momenta and impulses
  LimbScale angular; // angular momenta
  LimbScale first_moment; // m x
  LimbScale inertia; // m x^2
  // Noise floor of energies: bound of the rounding of sums and of forces. Smaller energies are no
  // measure of errors.
  double noise = 0;
  // Noise floors of momenta and angular momenta: 1e11 times the rounding of one of their sums.
  double momentum_noise = 0, angular_noise = 0;
};

// The noise floor of energies over the rounding of a sum, so that the error of several sums is below
// a hundredth of that floor.
constexpr double energies_over_rounding = 256;

// Terms fit up to 2^20 times those of an element at strain one that moves at the speed of sound.
// Collective.
LedgerScales ledgerScales(const exec_space& space, MPI_Comm comm, const HexMesh& mesh);

// Sums of one kick over owned nodes; vectors take three places.
enum KickTerm : int {
  kick_kinetic, // m v+.v+/2
  kick_shadow, // m v-.v+/2
  kick_work, // dt f_k.(v- + v+)/2 for each force kind k
  kick_work_reaction = kick_work + static_cast<int>(num_force_kinds),
  kick_work_damping, // of mass-proportional damping: -dt alpha m |(v- + v+)/2|^2
  kick_power, // dU/du . v- (minus the nodal forces)
  kick_momentum, // m v+
  kick_angular = kick_momentum + 3, // x^n x m v+
  kick_impulse_external = kick_angular + 3, // dt f_external
  kick_impulse_contact = kick_impulse_external + 3,
  kick_impulse_reaction = kick_impulse_contact + 3,
  kick_impulse_damping = kick_impulse_reaction + 3,
  kick_moment_external = kick_impulse_damping + 3, // x^n x dt f_external
  kick_moment_reaction = kick_moment_external + 3,
  kick_moment_damping = kick_moment_reaction + 3,
  kick_load_magnitude = kick_moment_damping + 3, // dt |f_external|
  kick_fast_nodes, // a count in the high limb: nodes beyond SpeedTest
  num_kick_terms
};
using KickSums = LimbSums<num_kick_terms>;

// The term of the work of one force kind.
KOKKOS_INLINE_FUNCTION constexpr int kickWork(int kind) {
  return kick_work + kind;
}

// Counts owned nodes whose new velocity differs from `around` by more than `limit`, or is NaN.
struct SpeedTest {
  Vec3 around; // length/time
  double limit = HUGE_VAL; // length/time
};

// Sums of a state of motion over owned nodes.
enum MotionTerm : int {
  motion_kinetic, // m v.v/2
  motion_momentum, // m v
  motion_angular = motion_momentum + 3, // x x m v
  motion_first_moment = motion_angular + 3, // m x
  motion_inertia = motion_first_moment + 3, // m x.x
  num_motion_terms
};
using MotionSums = LimbSums<num_motion_terms>;

// Sums of this rank, from u and v. Not collective.
MotionSums motionOf(const exec_space& space, const HexMesh& mesh, const NodalState& state,
                    const LedgerScales& scales);

// Contact's part of the balance at step n+1, this rank's share, on the scale LedgerScales::energy.
// "Half" terms belong to the half step n+1/2, the others are totals since the start up to the kick
// of step n. Terms without contact are 0.
enum ContactEnergy : int {
  contact_stored_half, // normal springs: sum of k p^n p^{n+1} / 2
  contact_friction_stored_half, // tangential springs
  contact_friction_dissipated, // by sliding
  contact_damping_dissipated,
  contact_edge_stored_half, // edge-to-edge contact
  contact_edge_work, // work of edge-to-edge contact; part of the work of contact_force
  num_contact_energies
};
using ContactEnergySums = LimbSums<num_contact_energies>;

// Counts of a rank in a step, reduced together with the step's sums.
constexpr int num_host_counts = 6;
struct StepCounts {
  std::int64_t failures = 0; // for example of loads; any failure ends the run
  std::int64_t host[num_host_counts] = {}; // for the host program
};

} // namespace brickwall::mechanics
