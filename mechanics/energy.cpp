#include "mechanics/energy.hpp"

#include "mechanics/hex8_geometry.hpp"

#include <cmath>

namespace brickwall::mechanics {

namespace {

struct MeshExtremes {
  double force = 0; // (lambda + 2 mu) h^2
  double edge = 0; // h
  double fastest = 0; // sqrt((lambda + 2 mu)/rho)
  double inverse_slowest = 0;
  double farthest = 0; // coordinate magnitude
  KOKKOS_INLINE_FUNCTION MeshExtremes& operator+=(const MeshExtremes& b) {
    force = maxOf(force, b.force);
    edge = maxOf(edge, b.edge);
    fastest = maxOf(fastest, b.fastest);
    inverse_slowest = maxOf(inverse_slowest, b.inverse_slowest);
    farthest = maxOf(farthest, b.farthest);
    return *this;
  }
};

MeshExtremes extremesOf(const exec_space& space, const MeshViews& m, int num_elems) {
  MeshExtremes result;
  Kokkos::parallel_reduce(
      "mechanics::ledgerScales::elements", over(space, num_elems),
      KOKKOS_LAMBDA(const std::int64_t elem, MeshExtremes& sum) {
        CornerCoordinates X;
        gatherCorners(m.elem_to_nodes, m.reference_coordinates, static_cast<int>(elem), X);
        const Material material = m.materials(m.elem_block(elem));
        const double modulus = material.lambda() + 2 * material.mu();
        const double speed = std::sqrt(modulus / material.density);
        MeshExtremes one;
        one.edge = longestEdge(X);
        one.force = modulus * one.edge * one.edge;
        one.fastest = speed;
        one.inverse_slowest = 1 / speed;
        for (int c = 0; c < 8; ++c)
          for (int j = 0; j < 3; ++j)
            one.farthest = maxOf(one.farthest, std::fabs(X[c][j]));
        sum += one;
      },
      Combine<MeshExtremes>(result));
  space.fence();
  return result;
}

} // namespace

LedgerScales ledgerScales(const exec_space& space, MPI_Comm comm, const HexMesh& mesh) {
  const MeshExtremes local = extremesOf(space, viewsOf(mesh), mesh.num_elems);
  double e[5] = {local.force, local.edge, local.fastest, local.inverse_slowest, local.farthest};
  allReduce(comm, e, 5, MPI_MAX);
  constexpr double headroom = 1048576; // 2^20
  const double energy = headroom * e[0] * e[1], momentum = energy * e[3];
  return {LimbScale::forLargest(energy), LimbScale::forLargest(headroom * e[0] * e[2]),
          LimbScale::forLargest(momentum), LimbScale::forLargest(momentum * (e[4] + e[1]))};
}

KickSums momentaOf(const exec_space& space, const HexMesh& mesh, const NodalState& state,
                   const LedgerScales& scales) {
  const MeshViews m = viewsOf(mesh);
  const NodalState s = state;
  KickSums result;
  Kokkos::parallel_reduce(
      "mechanics::momentaOf::nodes", over(space, mesh.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node, KickSums& sums) {
        if (!m.node_is_owned(node))
          return;
        const Vec3 v = rowOf(s.velocity, node), momentum = s.mass(node) * v;
        const Vec3 x = rowOf(m.reference_coordinates, node) + rowOf(s.displacement, node);
        const Vec3 angular = cross(x, momentum);
        sums.add(kick_kinetic, 0.5 * dot(momentum, v), scales.energy);
        for (int i = 0; i < 3; ++i) {
          sums.add(kick_momentum + i, momentum[i], scales.momentum);
          sums.add(kick_angular + i, angular[i], scales.angular);
        }
      },
      Combine<KickSums>(result));
  space.fence();
  return result;
}

namespace {

Vec3 vectorOf(const KickSums& sums, int first, const LimbScale& scale) {
  return {sums.sum[first].value(scale), sums.sum[first + 1].value(scale),
          sums.sum[first + 2].value(scale)};
}

// Everything that one step adds over the ranks, as one message.
struct StepSums {
  KickSums kick;
  LimbSums<num_stored_energies> stored;
  ContactEnergySums contact;
  std::int64_t failures = 0;
  std::int64_t* data() { return reinterpret_cast<std::int64_t*>(this); }
  static constexpr int size() { return sizeof(StepSums) / sizeof(std::int64_t); }
};

} // namespace

EnergyLedger::EnergyLedger(MPI_Comm comm, const LedgerScales& scales, const Vec3& gravity,
                           double total_mass, const KickSums& initial)
    : _scales(scales), _gravity(gravity), _total_mass(total_mass) {
  KickSums sums = initial;
  allReduce(comm, sums);
  _balance.kinetic = sums.sum[kick_kinetic].value(scales.energy);
  _balance.momentum = vectorOf(sums, kick_momentum, scales.momentum);
  _balance.angular_momentum = vectorOf(sums, kick_angular, scales.angular);
  _balance.failures = sums.invalid;
  _balance.peak_kinetic = _balance.kinetic;
  _initial_kinetic = _balance.kinetic;
  _initial_momentum = _balance.momentum;
}

void EnergyLedger::bookStep(MPI_Comm comm, double dt_kick, double dt,
                            const InternalForceResult& internal, const ContactEnergySums& contact,
                            const KickSums& kick, std::int64_t other_failures) {
  StepSums step{kick, internal.energy, contact, internal.failure.count + other_failures};
  allReduce(comm, step.data(), StepSums::size(), MPI_SUM);
  _balance.failures =
      step.failures + step.kick.invalid + step.stored.invalid + step.contact.invalid;
  if (_balance.failures > 0)
    return;

  const LimbScale& scale = _scales.energy;
  double work[num_force_kinds];
  for (int kind = 0; kind < num_force_kinds; ++kind)
    work[kind] = step.kick.sum[kick_work + kind].value(scale);
  const double internal_power = step.kick.sum[kick_internal_power].value(_scales.power);
  const double power_after =
      -2 * (work[material_force] + work[hourglass_force]) / dt_kick - internal_power;
  const double stored =
      (internal.has_energy ? 1 : 0) * (step.stored.sum[stored_material].value(scale) +
                                       step.stored.sum[stored_hourglass].value(scale));

  // The half step before these forces: kinetic energy and external work are still those of the last kick.
  _balance.stored_contact = step.contact.sum[contact_stored_half].value(scale);
  _balance.dissipated.contact = step.contact.sum[contact_dissipated].value(scale);
  _balance.dissipated.damping = -_balance.work_damping;
  if (!_started) {
    _initial_energy = _balance.kinetic + stored + 0.25 * dt * (power_after - internal_power);
    _has_initial_energy = internal.has_energy;
  } else if (internal.has_energy && _has_stored) {
    gaugeHalfStep(stored, internal_power);
  }
  if (internal.has_energy) {
    _balance.stored_material = step.stored.sum[stored_material].value(scale);
    _balance.stored_hourglass = step.stored.sum[stored_hourglass].value(scale);
  }
  _started = true;
  _has_stored = internal.has_energy;
  _stored = stored;
  _power_after = power_after;
  _dt = dt;

  bookWorks(dt_kick, work, step.kick);
  bookImpulses(dt_kick, step.kick);
}

void EnergyLedger::gaugeHalfStep(double stored, double internal_power) {
  EnergyBalance& b = _balance;
  b.stored_half = 0.5 * (_stored + stored) - 0.25 * _dt * (internal_power - _power_after);
  b.total_half = b.kinetic + b.stored_half + b.stored_contact + b.dissipated.total();
  if (!_has_initial_energy) {
    _initial_energy = b.total_half - b.external_work;
    _has_initial_energy = true;
  }
  const double held = b.stored_half + b.stored_contact;
  b.peak_stored = std::max(b.peak_stored, held);
  _peak_total = std::max(_peak_total, b.kinetic + held);
  _largest_energy_gap =
      std::max(_largest_energy_gap, std::fabs(b.total_half - b.external_work - _initial_energy));
  b.energy_error = _peak_total > 0 ? _largest_energy_gap / _peak_total : 0;
}

void EnergyLedger::bookWorks(double dt_kick, const double (&work)[num_force_kinds],
                             const KickSums& kick) {
  EnergyBalance& b = _balance;
  double sum_of_works = 0, sum_of_magnitudes = 0;
  for (int kind = 0; kind < num_force_kinds; ++kind) {
    b.work[kind] += work[kind];
    sum_of_works += b.work[kind];
    sum_of_magnitudes += std::fabs(b.work[kind]);
  }
  const Vec3 momentum = vectorOf(kick, kick_momentum, _scales.momentum);
  b.work_gravity += 0.5 * dt_kick * dot(_gravity, b.momentum + momentum);
  b.work_reaction += kick.sum[kick_work_reaction].value(_scales.energy);
  b.work_damping += kick.sum[kick_work_damping].value(_scales.energy);
  b.external_work = b.work[external_force] + b.work_gravity + b.work_reaction;
  b.kinetic = kick.sum[kick_kinetic].value(_scales.energy);
  b.peak_kinetic = std::max(b.peak_kinetic, b.kinetic);
  sum_of_works += b.work_gravity + b.work_reaction + b.work_damping;
  sum_of_magnitudes +=
      std::fabs(b.work_gravity) + std::fabs(b.work_reaction) + std::fabs(b.work_damping);
  const double size = _initial_kinetic + b.peak_kinetic + sum_of_magnitudes;
  b.ledger_residual = size > 0 ? std::fabs(b.kinetic - _initial_kinetic - sum_of_works) / size : 0;
}

void EnergyLedger::bookImpulses(double dt_kick, const KickSums& kick) {
  EnergyBalance& b = _balance;
  b.momentum = vectorOf(kick, kick_momentum, _scales.momentum);
  b.angular_momentum = vectorOf(kick, kick_angular, _scales.angular);
  b.impulse_external += vectorOf(kick, kick_impulse_external, _scales.momentum);
  b.impulse_contact += vectorOf(kick, kick_impulse_contact, _scales.momentum);
  b.impulse_reaction += vectorOf(kick, kick_impulse_reaction, _scales.momentum);
  b.impulse_damping += vectorOf(kick, kick_impulse_damping, _scales.momentum);
  b.impulse_gravity += (dt_kick * _total_mass) * _gravity;
  const Vec3 gap = b.impulse_external + b.impulse_gravity + b.impulse_reaction + b.impulse_damping -
                   (b.momentum - _initial_momentum);
  _largest_momentum_gap = std::max(_largest_momentum_gap, norm(gap));
  _largest_load = std::max(_largest_load, norm(b.impulse_external));
  // Without loads: the momenta of the parts, which may cancel in the sum, are at most sqrt(2 K M) (Cauchy-Schwarz).
  _largest_other = std::max({_largest_other, std::sqrt(2 * b.kinetic * _total_mass),
                             norm(b.impulse_gravity), norm(b.impulse_reaction)});
  const double size = _largest_load > 0 ? _largest_load : _largest_other;
  b.momentum_error = size > 0 ? _largest_momentum_gap / size : 0;
}

} // namespace brickwall::mechanics
