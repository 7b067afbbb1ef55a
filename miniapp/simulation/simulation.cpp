#include "miniapp/simulation/simulation.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "contact/enforcement/law/edge_fading.hpp"
#include "mechanics/ledger/force_power.hpp"
#include "mechanics/step/central_difference.hpp"

namespace brickwall::miniapp {

void Simulation::step() {
  moveNodes();
  findContactCandidates();
  guardAgainstTunnelling();
  auditCandidates();
  adaptTimeStep();
  computeInternalForces();
  limitStepForCompression();
  addLoads(nextLoadSpan());
  sumSharedNodes();
  enforceContact(_clock.dt_before);
  setContactPower();
  kickVelocities(0.5 * (_clock.dt_before + _clock.dt));
  bookEnergies(0.5 * (_clock.dt_before + _clock.dt));
}

void Simulation::start() {
  findContactCandidates();
  auditCandidates();
  computeInternalForces();
  limitStepForCompression();
  addLoads(nextLoadSpan());
  sumSharedNodes();
  enforceContact(_clock.dt);
  kickVelocities(0.5 * _clock.dt);
  bookEnergies(0.5 * _clock.dt);
}

void Simulation::moveNodes() {
  saveStateForGuard();
  const Region region("step::drift");
  // Free bricks drift while they are swept, unless someone looks at the positions before.
  _free_have_drifted = _free_bricks.any() && checksStableStep(_clock.step + 1);
  if (_free_have_drifted || movingNodes().all || !host_accessible)
    mechanics::drift(_space, _clock.dt, _state);
  else
    mechanics::drift(_space, _clock.dt, _state, movingNodes());
  if (_coupling)
    _coupling->gatherCoordinates(_space, _state.displacement);
  _clock.advance();
}

void Simulation::findContactCandidates() {
  if (!_coupling)
    return;
  const Region region("search");
  growSearchTolerance();
  _search->update(_space, _coupling->surface());
  if (_edges)
    _edges->findCandidates(_space, _coupling->surface());
}

void Simulation::auditCandidates() {
  if (!_coupling || _config.search.audit == 0 || _clock.step % _config.search.audit != 0)
    return;
  const Region region("step::audit of pairs");
  _missed_pairs += _search->countMissedPairs(_space, _coupling->surface());
  if (_edges)
    _missed_pairs += _edges->countMissedPairs(_space);
}

// Boxes of node and face together reach as far as the deepest loaded contact may fade out beyond an edge (its depth times
// depths_to_end, and a little), but no farther than the shortest edge: a node that is pressed in deep keeps its faces. They grow
// with some reserve and shrink late, so that lists that are kept stay of use.
double Simulation::reachOf(double deepest) const {
  constexpr double depths_to_end = contact::FadeRegion::depths_to_end;
  const double wanted = 0.5 * ((depths_to_end + 0.2) * deepest +
                               0.1 * _config.contact.edge_tolerance * _scene.longest_edge);
  return deepest > 0 ? minOf(wanted, 0.5 * _scene.shortest_edge) : 0;
}
void Simulation::growSearchTolerance() {
  if (_ledger.balance().host_counts[deeper_than_boxes] == 0 && _reach == _box_tolerance)
    return;
  const double deepest = maxOf(_contact.nodes.deepest, _contact.edges.deepest);
  const double wanted = reachOf(allReduce(_comm, deepest, MPI_MAX));
  if (wanted > _reach)
    _reach = 1.25 * wanted;
  else if (wanted < 0.5 * _reach)
    _reach = maxOf(_box_tolerance, wanted);
  _search->setTolerances(_reach, _reach);
  if (_edges)
    _edges->setTolerance(_reach);
}

void Simulation::computeInternalForces() {
  _has_all_forces = !_free_bricks.any();
  if (_other_nodes.numRuns() > 0)
    mechanics::zeroForces(_space, _forces);
  else
    _forces.values = View<std::int64_t**>(); // needed for output only
  const Region region("step::internal force");
  _resting_elems = _resting.numElems();
  _internal = _internal_force->add(_space, _state.displacement, _state.velocity, _config.viscosity,
                                   _forces, true);
}

// What the kick covers: from where the last one ended, to the bit, so that no part of a pulse is lost or counted twice, to the
// middle of the step to come.
mechanics::TimeSpan Simulation::nextLoadSpan() const {
  return {_load_span.end, _clock.time + 0.5 * _clock.dt};
}

void Simulation::addLoads(const mechanics::TimeSpan& span) {
  const Region region("step::loads");
  _load_span_before = _load_span;
  _load_span = span;
  _load_failures = 0;
  for (const auto& load : _loads)
    _load_failures += load.add(_space, _scene.mesh, _state.displacement, span, _forces);
}

void Simulation::sumSharedNodes() {
  const Region region("step::shared-node sum");
  _shared.sum(_space, _forces.values);
}

void Simulation::enforceContact(double dt) {
  if (!_enforcement)
    return;
  const Region region("step::contact enforcement");
  const contact::Surface surface = _coupling->surface();
  const auto sum_forces = [&](const contact::ContactForces& forces) {
    _coupling->sumContactForces(_space, forces, *_search, _shared);
  };
  contact::NeutralInput neutral;
  if (_config.contact.scheme == ContactScheme::energy_neutral) {
    neutral.accelerations = [&](const contact::NodeList& wanted) {
      return _coupling->accelerations(_space, wanted, _forces, _state, 0.5 * (dt + _clock.dt),
                                      _boundary);
    };
    neutral.sum_forces = sum_forces;
    neutral.share_with_ghosts = [&](const View<const double* [3]>& values,
                                    const View<double* [12]>& ghost_values) {
      _search->forward(_space, surface, values, ghost_values);
    };
  }
  _contact = _enforcement->enforce(_space, surface, _search->ghosts(), _search->pairs(),
                                   {dt, _clock.dt}, &neutral, _edges.get());
  _lost += _contact.lost();
  _penetration =
      maxOf(_penetration, maxOf(_contact.nodes.max_penetration, _contact.edges.max_penetration));
  if (!_enforcement->hasForces())
    return; // computeInternalForces() left zeros
  sum_forces(_enforcement->forces());
  _coupling->storeContactForces(_space, _enforcement->touched(), _enforcement->forces(), _forces);
}

// What the gauges need where the step changes: the power of contact before the kick.
void Simulation::setContactPower() {
  if (_enforcement && _clock.dt != _clock.dt_before)
    _ledger.setContactPower(mechanics::forcePower(_space, _comm, _scene.mesh, _forces, _state,
                                                  mechanics::contact_force, _scales));
}

// All nodes but those of bricks that step by themselves and of bodies at rest.
const mechanics::NodeSelection& Simulation::movingNodes() const {
  return _resting.any() ? _resting.movingNodes() : _other_nodes;
}

void Simulation::kickVelocities(double dt_kick) {
  const mechanics::TimeSpan next_drift{_clock.time, _clock.time + _clock.dt};
  {
    const Region region("step::kick");
    _resting.wake(_space, _forces);
    const mechanics::SpeedTest test = _guard.speedTest(_ledger.meanVelocity());
    _kick = mechanics::kick(_space, _scene.mesh, _boundary, next_drift, dt_kick, _forces, _state,
                            _scales, test, movingNodes());
  }
  if (_free_bricks.any())
    stepFreeBricks(dt_kick, next_drift);
}

void Simulation::stepFreeBricks(double dt_kick, const mechanics::TimeSpan& next_drift) {
  const Region region("step::free bricks");
  const auto sums =
      _free_bricks.step(_space, _scene.mesh, *_internal_force, _boundary, next_drift,
                        !_free_have_drifted, _clock.dt_before, dt_kick, _state, _scales);
  _internal.energy += sums.internal.energy;
  _internal.failure += sums.internal.failure;
  _kick += sums.kick;
}

void Simulation::allocateForces() {
  _forces.values = View<std::int64_t**>("state::forces", _scene.mesh.num_nodes,
                                        mechanics::numForceColumns(_config.viscosity.any()));
}

const mechanics::NodalForces& Simulation::forces() {
  if (!_has_all_forces) {
    if (_other_nodes.numRuns() == 0)
      allocateForces();
    _internal_force->addLeftOut(_space, _state.displacement, _forces);
    _has_all_forces = true;
  }
  return _forces;
}

void Simulation::bookEnergies(double dt_kick) {
  const Region region("step::ledger");
  _skipped_element_steps += _resting_elems;
  mechanics::StepCounts counts;
  counts.failures = _load_failures + _contact.failures();
  counts.host[deeper_than_warned] = _penetration > _config.limits.warn[gauge_penetration];
  counts.host[deeper_than_allowed] = _penetration > _config.limits.stop[gauge_penetration];
  counts.host[deeper_than_boxes] =
      reachOf(maxOf(_contact.nodes.deepest, _contact.edges.deepest)) > _box_tolerance;
  _ledger.bookStep(_comm, dt_kick, _clock.dt, _internal, _contact_ledger.add(_contact), _kick,
                   counts);
  if (_ledger.balance().failures > 0) {
    const std::string failure = describeFailure();
    stepBack(dt_kick);
    throw PhysicsError(failure);
  }
}

} // namespace brickwall::miniapp
