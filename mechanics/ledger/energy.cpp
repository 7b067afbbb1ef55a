#include "mechanics/ledger/energy.hpp"

#include <algorithm>
#include <cmath>

namespace brickwall::mechanics {

namespace {

template <int N>
Vec3 vectorOf(const LimbSums<N>& sums, int first, const LimbScale& scale) {
  return {sums.sum[first].value(scale), sums.sum[first + 1].value(scale),
          sums.sum[first + 2].value(scale)};
}

// All sums of a step over the ranks, as one message.
struct StepSums {
  KickSums kick;
  LimbSums<num_stored_energies> stored;
  ContactEnergySums contact;
  StepCounts counts;
  std::int64_t* data() { return reinterpret_cast<std::int64_t*>(this); }
  static constexpr int size() { return sizeof(StepSums) / sizeof(std::int64_t); }
};

void raise(double& largest, double value) {
  largest = std::max(largest, value);
}

double quotient(double part, double whole) {
  return whole > 0 ? part / whole : 0;
}

} // namespace

EnergyLedger::EnergyLedger(MPI_Comm comm, const LedgerScales& scales, const Vec3& gravity,
                           double total_mass, const MotionSums& initial)
    : _scales(scales), _gravity(gravity), _total_mass(total_mass) {
  MotionSums sums = initial;
  allReduce(comm, sums);
  _balance.kinetic = sums.sum[motion_kinetic].value(scales.energy);
  _balance.momentum = vectorOf(sums, motion_momentum, scales.momentum);
  _balance.angular_momentum = vectorOf(sums, motion_angular, scales.angular);
  _balance.failures = sums.invalid;
  _balance.peak_kinetic = _balance.kinetic;
  _initial_kinetic = _balance.kinetic;
  _initial_momentum = _balance.momentum;
  _initial_angular = _balance.angular_momentum;
  _first_moment = vectorOf(sums, motion_first_moment, scales.first_moment);
  _radius_of_gyration =
      std::sqrt(quotient(sums.sum[motion_inertia].value(scales.inertia), total_mass));
}

void EnergyLedger::bookStep(MPI_Comm comm, double dt_kick, double dt,
                            const InternalForceResult& internal, const ContactEnergySums& contact,
                            const KickSums& kick, const StepCounts& counts) {
  StepSums step{kick, internal.energy, contact, counts};
  step.counts.failures += internal.failure.count;
  allReduce(comm, step.data(), StepSums::size(), MPI_SUM);
  _balance.failures =
      step.counts.failures + step.kick.invalid + step.stored.invalid + step.contact.invalid;
  if (_balance.failures > 0)
    return;

  for (int i = 0; i < num_host_counts; ++i)
    _balance.host_counts[i] = step.counts.host[i];
  // The half step before these forces: kinetic energy and works are still those of the last kick.
  bookStored(dt_kick, dt, internal, step.stored, step.kick);
  bookContact(step.contact);
  if (_stored.hasHalf())
    gaugeHalfStep();
  else if (_steps == 0) // there is no half step before the start
    _balance.total_half = _balance.kinetic + _balance.stored_material + _balance.stored_hourglass;

  const double shadow = step.kick.sum[kick_shadow].value(_scales.energy);
  // over the drift that led to this step; 0 at the start
  _first_moment += _dt * _balance.momentum;
  bookWorks(dt_kick, step.kick);
  bookImpulses(dt_kick, step.kick);
  bookMoments(dt_kick, step.kick);
  // At the start the kick begins with v^0 = (v^{-1/2} + v^{1/2})/2.
  const double kinetic_part = _steps == 0 ? 2 * shadow - _balance.kinetic : shadow;
  _balance.shadow = kinetic_part + _balance.stored_material + _balance.stored_hourglass;
  _balance.fast_nodes = step.kick.sum[kick_fast_nodes].high;
  _dt = dt;
  ++_steps;
}

void EnergyLedger::bookCorrection(MPI_Comm comm, double dt_kick, double dt, const KickSums& kick) {
  KickSums sums = kick;
  allReduce(comm, sums);
  _balance.failures = sums.invalid;
  if (_balance.failures > 0)
    return;
  _stored.correct(sums.sum[kick_power].value(_scales.power),
                  sums.sum[kickWork(internal_force)].value(_scales.energy), dt_kick, dt);
  bookWorks(dt_kick, sums);
  bookImpulses(dt_kick, sums);
  bookMoments(dt_kick, sums);
  _dt = dt;
}

Vec3 EnergyLedger::meanVelocity() const {
  return quotient(1, _total_mass) * _balance.momentum;
}

void EnergyLedger::bookStored(double dt_kick, double dt, const InternalForceResult& internal,
                              const LimbSums<num_stored_energies>& stored, const KickSums& kick) {
  const double material = stored.sum[stored_material].value(_scales.energy);
  const double hourglass = stored.sum[stored_hourglass].value(_scales.energy);
  _stored.book(internal.has_energy, material + hourglass, kick.sum[kick_power].value(_scales.power),
               kick.sum[kickWork(internal_force)].value(_scales.energy), dt_kick, dt);
  if (_steps == 0) {
    _has_initial_energy = internal.has_energy;
    _initial_hourglass = hourglass;
  }
  if (!internal.has_energy)
    return;
  EnergyBalance& b = _balance;
  b.stored_material = material;
  b.stored_hourglass = hourglass;
  b.work_hourglass = _initial_hourglass - hourglass;
  raise(b.peak_internal, b.stored_material + b.stored_hourglass);
  raise(b.peak_hourglass, b.stored_hourglass);
}

void EnergyLedger::bookContact(const ContactEnergySums& contact) {
  const auto value = [&](int i) { return contact.sum[i].value(_scales.energy); };
  EnergyBalance& b = _balance;
  b.stored_contact = value(contact_stored_half);
  b.stored_friction = value(contact_friction_stored_half);
  b.stored_edge = value(contact_edge_stored_half);
  b.dissipated.friction = value(contact_friction_dissipated);
  b.dissipated.contact_damping = value(contact_damping_dissipated);
  b.dissipated.damping = -b.work_damping;
  b.dissipated.viscosity = -b.work[viscous_force];
  b.work_edge = value(contact_edge_work);
}

void EnergyLedger::gaugeHalfStep() {
  EnergyBalance& b = _balance;
  const double in_contact = b.stored_contact + b.stored_friction + b.stored_edge;
  b.stored_half = _stored.half();
  const double held = b.stored_half + in_contact;
  b.total_half = b.kinetic + held + b.dissipated.total() - _stored.change();
  if (_has_initial_energy && _steps == 1) // a correction of the start has changed its gauge
    _initial_energy = _initial_kinetic + _stored.initial();
  if (!_has_initial_energy) {
    _initial_energy = b.total_half - b.external_work;
    _has_initial_energy = true;
  }
  raise(b.peak_stored, held);
  raise(b.peak_total, b.kinetic + held);
  const double size = std::max(b.peak_total, _scales.noise);
  b.is_above_noise = b.peak_total >= _scales.noise;
  raise(_energy_gap, std::fabs(b.total_half - b.external_work - _initial_energy));
  b.energy_error = quotient(_energy_gap, size);

  raise(_stored_gap,
        std::fabs(_stored.half() - _stored.initial() - _stored.change() + b.work[internal_force]));
  raise(_contact_gap, std::fabs(in_contact + b.dissipated.inContact() + b.work[contact_force]));
  b.stored_error = quotient(_stored_gap, size);
  b.contact_error = quotient(_contact_gap, size);
}

void EnergyLedger::bookWorks(double dt_kick, const KickSums& kick) {
  EnergyBalance& b = _balance;
  double sum_of_works = 0, sum_of_magnitudes = 0;
  for (int kind = 0; kind < num_force_kinds; ++kind) {
    b.work[kind] += kick.sum[kickWork(kind)].value(_scales.energy);
    sum_of_works += b.work[kind];
    sum_of_magnitudes += std::fabs(b.work[kind]);
  }
  const Vec3 momentum = vectorOf(kick, kick_momentum, _scales.momentum);
  b.work_gravity += 0.5 * dt_kick * dot(_gravity, b.momentum + momentum);
  b.work_reaction += kick.sum[kick_work_reaction].value(_scales.energy);
  b.work_damping += kick.sum[kick_work_damping].value(_scales.energy);
  b.external_work = b.work[external_force] + b.work_gravity + b.work_reaction;
  b.kinetic = kick.sum[kick_kinetic].value(_scales.energy);
  raise(b.peak_kinetic, b.kinetic);
  for (const double other : {b.work_gravity, b.work_reaction, b.work_damping}) {
    sum_of_works += other;
    sum_of_magnitudes += std::fabs(other);
  }
  b.ledger_residual = quotient(std::fabs(b.kinetic - _initial_kinetic - sum_of_works),
                               _initial_kinetic + b.peak_kinetic + sum_of_magnitudes);
}

void EnergyLedger::bookImpulses(double dt_kick, const KickSums& kick) {
  EnergyBalance& b = _balance;
  b.momentum = vectorOf(kick, kick_momentum, _scales.momentum);
  b.impulse_external += vectorOf(kick, kick_impulse_external, _scales.momentum);
  b.impulse_contact += vectorOf(kick, kick_impulse_contact, _scales.momentum);
  b.impulse_reaction += vectorOf(kick, kick_impulse_reaction, _scales.momentum);
  b.impulse_damping += vectorOf(kick, kick_impulse_damping, _scales.momentum);
  b.impulse_gravity += (dt_kick * _total_mass) * _gravity;
  const Vec3 gap = b.impulse_external + b.impulse_gravity + b.impulse_reaction + b.impulse_damping -
                   (b.momentum - _initial_momentum);
  raise(_momentum_gap, norm(gap));
  // The norm of the impulse of the loads would be rounding where they cancel. This sum bounds it by
  // the triangle inequality, and is equal to it where all loads have one direction.
  _sum_of_loads += kick.sum[kick_load_magnitude].value(_scales.momentum);
  // Without loads the scale is sqrt(2 K M), which bounds the sum of the parts' momenta, which may
  // cancel (Cauchy-Schwarz).
  raise(_largest_other, std::max({std::sqrt(2 * b.kinetic * _total_mass), norm(b.impulse_gravity),
                                  norm(b.impulse_reaction)}));
  // A load that has only just begun is no measure.
  const double size =
      _sum_of_loads > 0 ? std::max(_sum_of_loads, 1e-4 * _largest_other) : _largest_other;
  b.momentum_error = quotient(_momentum_gap, std::max(size, _scales.momentum_noise));
}

void EnergyLedger::bookMoments(double dt_kick, const KickSums& kick) {
  EnergyBalance& b = _balance;
  b.angular_momentum = vectorOf(kick, kick_angular, _scales.angular);
  b.moment_external += vectorOf(kick, kick_moment_external, _scales.angular);
  b.moment_reaction += vectorOf(kick, kick_moment_reaction, _scales.angular);
  b.moment_damping += vectorOf(kick, kick_moment_damping, _scales.angular);
  b.moment_gravity += dt_kick * cross(_first_moment, _gravity);
  const Vec3 gap = b.moment_external + b.moment_gravity + b.moment_reaction + b.moment_damping -
                   (b.angular_momentum - _initial_angular);
  raise(_angular_gap, norm(gap));
  // The sum of the parts' angular momenta is at most R sqrt(2 K M) (Cauchy-Schwarz).
  raise(_largest_moment,
        std::max({norm(b.moment_external), norm(b.moment_gravity), norm(b.moment_reaction),
                  _radius_of_gyration * std::sqrt(2 * b.kinetic * _total_mass)}));
  b.angular_momentum_error =
      quotient(_angular_gap, std::max(_largest_moment, _scales.angular_noise));
}

} // namespace brickwall::mechanics
