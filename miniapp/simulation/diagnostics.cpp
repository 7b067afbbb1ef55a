// What a simulation tells of its steps: counts over all ranks, and the gauges of limits.
#include "contact/base/mpi.hpp"
#include "miniapp/simulation/simulation.hpp"

namespace brickwall::miniapp {

ContactCounts Simulation::contactCounts() const {
  ContactCounts counts;
  if (!_coupling)
    return counts;
  std::int64_t sums[4] = {_search->ghosts().count, _search->pairs().count, _contact.active(),
                          _lost};
  allReduce(_comm, sums, 4, MPI_SUM);
  counts.searches = _search->searches();
  counts.updates = _search->updates();
  counts.ghost_faces = sums[0];
  counts.candidate_pairs = sums[1];
  counts.active = sums[2];
  counts.lost = sums[3];
  counts.missed_pairs = _missed_pairs;
  counts.largest_penetration = allReduce(_comm, _penetration, MPI_MAX);
  counts.max_penetration = allReduce(
      _comm, maxOf(_contact.nodes.max_penetration, _contact.edges.max_penetration), MPI_MAX);
  return counts;
}

GaugeValues Simulation::gauges() {
  const mechanics::EnergyBalance& b = _ledger.balance();
  const LimitsConfig& limits = _config.limits;
  const bool is_deep = (b.host_counts[deeper_than_warned] > 0 &&
                        _known_penetration <= limits.warn[gauge_penetration]) ||
                       (b.host_counts[deeper_than_allowed] > 0 &&
                        _known_penetration <= limits.stop[gauge_penetration]);
  if (is_deep)
    _known_penetration = allReduce(_comm, _penetration, MPI_MAX);
  GaugeValues values;
  values[gauge_energy] = b.energy_error;
  values[gauge_momentum] = b.momentum_error;
  values[gauge_angular_momentum] = _is_objective ? b.angular_momentum_error : 0;
  values[gauge_contact] = b.contact_error;
  values[gauge_hourglass] = b.hourglassShare();
  values[gauge_penetration] = _known_penetration;
  return values;
}

mechanics::NeglectedStrain Simulation::neglectedStrain() const {
  const bool is_looked_at = checksStableStep(_clock.step) || done();
  return _is_objective || !is_looked_at
             ? mechanics::NeglectedStrain()
             : mechanics::neglectedStrain(_space, _comm, _scene.mesh, _state.displacement);
}

std::int64_t Simulation::numRestingElems() const {
  return allReduce(_comm, _resting.numElems(), MPI_SUM);
}
std::int64_t Simulation::skippedElementSteps() const {
  return allReduce(_comm, _skipped_element_steps, MPI_SUM);
}
std::int64_t Simulation::numFreeElems() const {
  return allReduce(_comm, _free_bricks.numElems(), MPI_SUM);
}

std::int64_t Simulation::numLatticeElems() const {
  std::int64_t count = 0;
  for (const auto& lattice : _internal_force->lattices().on_host)
    count += lattice.numElems();
  return allReduce(_comm, _config.viscosity.any() ? 0 : count, MPI_SUM);
}
std::int64_t Simulation::numCongruentElems() const {
  return allReduce(_comm, _internal_force->numCongruentElems(), MPI_SUM);
}

} // namespace brickwall::miniapp
