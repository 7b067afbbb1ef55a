// The ledger of energy and momentum and the half-step energy gauges; theory.md, equations (24) to
// (29).
// Ledger: v+ M v+/2 - v- M v-/2 = sum over k of dt f_k . (v+ + v-)/2, one term per force kind,
// exact for any forces. Since it is an identity, it does not verify the forces. The gauges do, all
// from exact sums:
//   energy        E^{n+1/2} = K(v^{n+1/2}) + stored at the half step (StoredGauge)
//                 + contact stored + dissipated
//   stored        stored energies against the work of their forces; a known change of the
//                 invariant with the length of the step (StoredGauge) is subtracted
//   contact       energy that contact has stored and dissipated against its work
//   shadow        H^n = v- M v+/2 + U^n, which is vbar M vbar/2 - (dt^2/8) a M a + U^n with
//                 vbar = (v- + v+)/2: the invariant of central differences for a linear body at
//                 constant dt without loads and contact
//   momentum      P^{n+1/2} - P^{n-1/2} = sum of dt f^n, and likewise the angular momentum about
//                 the origin: L^{n+1/2} = sum of x^n x m v^{n+1/2}; since x^n - x^{n-1} is parallel
//                 to v^{n-1/2} at each node, L^{n+1/2} - L^{n-1/2} = sum of x^n x dt f^n exactly,
//                 at any dt
#pragma once

#include "contact/base/mpi.hpp"
#include "contact/base/vec3.hpp"
#include "mechanics/ledger/ledger_sums.hpp"

#include <cstdint>

namespace brickwall::mechanics {

// Dissipated energy since the start, up to a half step, one term per mechanism; each is >= 0 up to
// rounding.
struct DissipatedEnergy {
  double friction = 0; // sliding contacts
  double contact_damping = 0;
  double damping = 0; // mass-proportional damping
  double viscosity = 0; // bulk viscosity; lagged, so a single step may return a little energy
  double inContact() const { return friction + contact_damping; }
  double total() const { return inContact() + damping + viscosity; }
};

// Global quantities, equal on all ranks. "Half" values belong to the half step before the last
// forces. Errors and peaks are the largest since the start. Energies below LedgerScales::noise are
// no measure of errors.
struct EnergyBalance {
  double kinetic = 0; // K(v^{n+1/2}) after the last kick
  double stored_material = 0; // U^n at the last evaluation
  double stored_hourglass = 0; // U^n of the hourglass modes
  double stored_half = 0; // elastic energy (material and hourglass) at the half step, by the gauge
  double stored_contact = 0; // normal contact springs, at the half step
  double stored_friction = 0; // tangential contact springs, at the half step
  double stored_edge = 0; // edge-to-edge contact, at the half step
  DissipatedEnergy dissipated; // up to the half step
  // kinetic + all stored + all dissipated at the half step, less the change of this invariant with
  // the length of the steps
  double total_half = 0;
  // H^n of the last step that began with v^{n-1/2}; elastic and kinetic energy only
  double shadow = 0;
  double work[num_force_kinds] = {}; // W_k since the start
  // of hourglass stiffness up to the positions of step n, by its energy; part of
  // work[internal_force]
  double work_hourglass = 0;
  double work_edge = 0; // of edge-to-edge contact; part of work[contact_force]
  double work_gravity = 0;
  double work_reaction = 0; // of prescribed motions
  double work_damping = 0; // of mass-proportional damping, <= 0
  double external_work = 0; // external + gravity + reaction, up to the last kick
  Vec3 momentum, angular_momentum; // at the last half step
  // since the start
  Vec3 impulse_external, impulse_gravity, impulse_reaction, impulse_damping, impulse_contact;
  // x cross impulse about the origin, since the start
  Vec3 moment_external, moment_gravity, moment_reaction, moment_damping;
  double energy_error = 0; // |total_half - external work - E_0| / peak_total
  double stored_error = 0; // |stored_half - U_0 + W_internal| / peak_total
  double contact_error = 0; // |contact stored + dissipated + W_contact| / peak_total
  // |impulses - change of momentum| / sum of |dt f| of the loads over nodes and steps, which bounds
  // their impulse also where loads cancel. Without loads it is relative to the largest of sqrt(2 K
  // M) and the other impulses; the denominator is at least 1e-4 of these.
  double momentum_error = 0;
  // |moments of impulses - change of angular momentum| / the largest of these moments and R sqrt(2
  // K M), R^2 = sum m |x|^2 / M
  double angular_momentum_error = 0;
  double ledger_residual = 0; // of the last step: |K - K_0 - sum W_k| / (K_0 + max K + sum |W_k|)
  double peak_kinetic = 0, peak_stored = 0;
  double peak_total = 0; // of kinetic + stored at half steps
  bool is_above_noise = false; // by peak_total; otherwise the errors of energy are meaningless
  double peak_internal = 0, peak_hourglass = 0; // of U^n, and of its hourglass part
  std::int64_t fast_nodes = 0; // nodes beyond the SpeedTest of the last kick, over all ranks
  std::int64_t host_counts[num_host_counts] = {}; // of the last step, over all ranks
  std::int64_t failures = 0; // failed elements, loads or sums of the last step, over all ranks

  // Peak hourglass energy over peak internal energy.
  double hourglassShare() const { return peak_internal > 0 ? peak_hourglass / peak_internal : 0; }
};

// Stored energy of elastic bodies at half steps from values at whole steps; theory.md, equations
// (26) and (27):
//   S^{n+1/2} = (U^n + U^{n+1})/2 - (dt/4) v^{n+1/2} . (dU/du^{n+1} - dU/du^n).
// For linear springs S = u^n.K.u^{n+1}/2, whose change at constant dt is exactly minus the work of
// central differences. Otherwise the error is of higher order than that of the mean (U^n +
// U^{n+1})/2.
// If the drift changes from dt to dt', the kick in between has their mean length, and K + S changes
// by (dt' - dt)/4 times dU/du^n . (v^{n+1/2} - v^{n-1/2}): S^{n+1/2} - S^{n-1/2} = dU/du^n . (dt'
// v^{n+1/2} + dt v^{n-1/2})/2, whereas in the work both velocities have the factor (dt + dt')/4.
// change() accumulates these differences.
class StoredGauge {
public:
  // Step n: U^n, `power` = dU/du^n . v^{n-1/2}, the work of -dU/du^n in the kick of length dt_kick,
  // and the length of the next drift. Without an energy the adjacent half steps have no value.
  void book(bool has_energy, double stored, double power, double work, double dt_kick, double dt) {
    _has_half = has_energy && _has_energy;
    if (_has_half)
      _half = 0.5 * (_stored + stored) - 0.25 * _dt * (power - _power_after);
    _has_energy = has_energy;
    _stored = stored;
    _power_before = power;
    _change += _change_now;
    _dt_before = _steps > 0 ? _dt : dt;
    ++_steps;
    correct(power, work, dt_kick, dt);
  }

  // A further kick by the same forces; `power` is that of the velocity before it.
  void correct(double power, double work, double dt_kick, double dt) {
    _power_after = -2 * work / dt_kick - power;
    _dt = dt;
    _change_now = 0.25 * (dt - _dt_before) * (_power_after - _power_before);
    // The sum of u^0.K.u^1/2 and the work of the first half kick, -dt u^0.K.(v^0 + v^{1/2})/4.
    if (_steps == 1)
      _change_now = 0, _initial = _stored + 0.25 * dt * (_power_after - _power_before);
  }

  bool hasHalf() const { return _has_half; }
  double half() const { return _half; } // of the half step before the last recorded step
  // Value of S before the start, so that S - initial() - change() is minus the work since then.
  double initial() const { return _initial; }
  // Change of the invariant with the lengths of the steps until the half step of half(); 0 for
  // constant steps.
  double change() const { return _change; }

private:
  std::int64_t _steps = 0;
  bool _has_energy = false, _has_half = false;
  double _stored = 0, _half = 0, _initial = 0;
  double _power_before = 0, _power_after = 0; // dU/du^n . v^{n-1/2} and . v^{n+1/2}
  double _dt = 0, _dt_before = 0;
  double _change = 0, _change_now = 0; // until half(); by the last recorded step
};

class EnergyLedger {
public:
  EnergyLedger() = default;
  // `initial` is this rank's motionOf the initial positions and velocities. Collective.
  EnergyLedger(MPI_Comm comm, const LedgerScales& scales, const Vec3& gravity, double total_mass,
               const MotionSums& initial);

  // Adds the kick with forces at step n to the ledger, with the step's one all-reduce of energies,
  // momenta and counts. `dt_kick` is the kick's dt (half a step at the start), `dt` the length of
  // the drift that follows. Half-step gauges are evaluated if `internal.has_energy` in this and the
  // previous call. `counts` holds failures of loads and sums for the host program. Afterwards
  // balance().failures > 0 on all ranks or on none; if it is, the rest of balance() is unchanged.
  // Collective.
  void bookStep(MPI_Comm comm, double dt_kick, double dt, const InternalForceResult& internal,
                const ContactEnergySums& contact, const KickSums& kick,
                const StepCounts& counts = {});

  // Adds a further kick by the same forces at step n: the next drift is `dt` long, so the kick
  // changes by `dt_kick` (negative if the step is shortened). Collective; failures as in
  // bookStep().
  void bookCorrection(MPI_Comm comm, double dt_kick, double dt, const KickSums& kick);

  const EnergyBalance& balance() const { return _balance; }
  Vec3 meanVelocity() const; // of the total mass, at the last half step

private:
  void bookStored(double dt_kick, double dt, const InternalForceResult& internal,
                  const LimbSums<num_stored_energies>& stored, const KickSums& kick);
  void gaugeHalfStep();
  void bookContact(const ContactEnergySums& contact);
  void bookWorks(double dt_kick, const KickSums& kick);
  void bookImpulses(double dt_kick, const KickSums& kick);
  void bookMoments(double dt_kick, const KickSums& kick);

  EnergyBalance _balance;
  LedgerScales _scales;
  Vec3 _gravity;
  double _total_mass = 0;
  double _initial_kinetic = 0, _initial_energy = 0;
  Vec3 _initial_momentum, _initial_angular;
  Vec3 _first_moment; // sum of m x^n
  double _radius_of_gyration = 0; // of the initial positions, about the origin
  std::int64_t _steps = 0; // recorded steps, including the start
  bool _has_initial_energy = false;
  StoredGauge _stored;
  double _initial_hourglass = 0; // energy
  double _dt = 0; // of the drift after the last kick
  // Largest absolute errors and scales since the start.
  double _energy_gap = 0, _stored_gap = 0, _contact_gap = 0;
  double _momentum_gap = 0, _sum_of_loads = 0, _largest_other = 0;
  double _angular_gap = 0, _largest_moment = 0;
};

} // namespace brickwall::mechanics
