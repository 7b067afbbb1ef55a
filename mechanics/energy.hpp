// The energy and momentum ledger (physics.md section 3) and the half-step energy gauge (contact_energy.md).
// Ledger: v+ M v+/2 - v- M v-/2 = sum over k of dt f_k . (v+ + v-)/2, one term per force kind, exact for any forces.
// Gauge: E^{n+1/2} = K(v^{n+1/2}) + (U^n + U^{n+1})/2 - (dt/4) v^{n+1/2} . (dU/du^{n+1} - dU/du^n) + contact stored,
// which for linear springs is K + u^n.K.u^{n+1}/2, exactly conserved at constant dt.
#pragma once

#include "contact/base/mpi.hpp"
#include "contact/base/vec3.hpp"
#include "mechanics/internal_force.hpp"
#include "mechanics/nodal_state.hpp"

namespace brickwall::mechanics {

// Scales of the exact sums, from input data only, so the same on every rank.
struct LedgerScales {
  LimbScale energy; // energies and works
  LimbScale power; // f . v
  LimbScale momentum; // momenta and impulses
  LimbScale angular; // angular momenta
};

// Terms up to 2^20 times those of an element at strain one moving at the speed of sound fit. Collective.
LedgerScales ledgerScales(const exec_space& space, MPI_Comm comm, const HexMesh& mesh);

// Sums over owned nodes made by one kick; vectors take three places.
enum KickTerm : int {
  kick_kinetic, // m v+.v+/2
  kick_work, // dt f_k.(v- + v+)/2 for each force kind k
  kick_work_reaction = kick_work + num_force_kinds,
  kick_work_damping, // of damping by mass: -dt alpha m |(v- + v+)/2|^2
  kick_internal_power, // dU/du . v- (minus the nodal internal forces)
  kick_momentum, // m v+
  kick_angular = kick_momentum + 3, // x^n x m v+
  kick_impulse_external = kick_angular + 3, // dt f_external
  kick_impulse_contact = kick_impulse_external + 3,
  kick_impulse_reaction = kick_impulse_contact + 3,
  kick_impulse_damping = kick_impulse_reaction + 3,
  num_kick_terms = kick_impulse_damping + 3
};
using KickSums = LimbSums<num_kick_terms>;

// Kinetic energy and momenta of a velocity field, as kick makes them (only those terms are set). Not collective.
KickSums momentaOf(const exec_space& space, const HexMesh& mesh, const NodalState& state,
                   const LedgerScales& scales);

// Contact's part of the balance at step n+1, this rank's share, in LedgerScales::energy.
enum ContactEnergy : int {
  contact_stored_half, // sum of k p^n p^{n+1} / 2, of the half step n+1/2
  contact_dissipated, // so far in total (friction, damping); 0 where there is none
  num_contact_energies
};
using ContactEnergySums = LimbSums<num_contact_energies>;

// Energy lost for good since the start, up to a half step, one term a mechanism; each >= 0 but for rounding.
struct DissipatedEnergy {
  double contact = 0; // friction and contact damping
  double damping = 0; // damping by mass
  double total() const { return contact + damping; }
};

// Everything global, equal on all ranks. "Half" values belong to the half step before the last forces.
struct EnergyBalance {
  double kinetic = 0; // K(v^{n+1/2}) after the last kick
  double stored_material = 0; // U^n at the last evaluation
  double stored_hourglass = 0; // "
  double stored_half = 0; // elastic (material + hourglass) energy at the half step, by the gauge
  double stored_contact = 0; // at the half step
  DissipatedEnergy dissipated; // "
  double total_half = 0; // kinetic + stored_half + stored_contact + all dissipated at the half step
  double work[num_force_kinds] = {}; // W_k since the start
  double work_gravity = 0;
  double work_reaction = 0; // of prescribed motions
  double work_damping = 0; // of damping by mass, <= 0
  double external_work = 0; // external + gravity + reaction, up to the last kick
  Vec3 momentum, angular_momentum; // at the last half step
  // since the start
  Vec3 impulse_external, impulse_gravity, impulse_reaction, impulse_damping, impulse_contact;
  double energy_error = 0; // so far: max |total_half - external work - E_0| / max (K + stored)
  // So far: max |impulses - change of momentum| / max |impulse of loads|; without loads, over the largest of
  // sqrt(2 K M) and the other impulses.
  double momentum_error = 0;
  double ledger_residual = 0; // now: |K - K_0 - sum W_k| / (K_0 + max K + sum |W_k|)
  double peak_kinetic = 0, peak_stored = 0;
  std::int64_t failures = 0; // failed elements, loads or sums of the last step, over all ranks
};

class EnergyLedger {
public:
  EnergyLedger() = default;
  // `initial`: momentaOf the initial velocity v^0 (this rank's). Collective.
  EnergyLedger(MPI_Comm comm, const LedgerScales& scales, const Vec3& gravity, double total_mass,
               const KickSums& initial);

  // Books the kick with forces at step n: the step's one all-reduce of energies, momenta and failure count. `dt_kick`
  // is the kick's dt (half a step at the start), `dt` the step of the drift that follows it. The gauge is evaluated when
  // `internal.has_energy` in this and the previous call. `other_failures`: e.g. of loads. Afterwards
  // balance().failures > 0 on all ranks or none; then everything else in balance() is as before. Collective.
  void bookStep(MPI_Comm comm, double dt_kick, double dt, const InternalForceResult& internal,
                const ContactEnergySums& contact, const KickSums& kick,
                std::int64_t other_failures = 0);

  const EnergyBalance& balance() const { return _balance; }

private:
  void gaugeHalfStep(double stored, double internal_power);
  void bookWorks(double dt_kick, const double (&work)[num_force_kinds], const KickSums& kick);
  void bookImpulses(double dt_kick, const KickSums& kick);

  EnergyBalance _balance;
  LedgerScales _scales;
  Vec3 _gravity;
  double _total_mass = 0;
  double _initial_kinetic = 0, _initial_energy = 0;
  Vec3 _initial_momentum;
  bool _started = false, _has_stored = false, _has_initial_energy = false;
  double _stored = 0; // U^n
  double _power_after = 0; // dU/du^n . v^{n+1/2}
  double _dt = 0; // of the drift after the last kick
  double _peak_total = 0, _largest_energy_gap = 0;
  double _largest_momentum_gap = 0, _largest_load = 0, _largest_other = 0;
};

} // namespace brickwall::mechanics
