#include "miniapp/simulation/simulation.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "mechanics/step/central_difference.hpp"
#include "mechanics/step/nodal_motion.hpp"
#include "miniapp/simulation/diagnostics.hpp"

namespace brickwall::miniapp {

// The start is a step without a drift: stages that follow from motion do nothing then.
void Simulation::runStages(bool moves) {
  if (moves) {
    balanceContact();
    moveNodes();
  }
  findContactCandidates();
  guardAgainstTunnelling();
  finish(StepPart::displacement);
  finish(StepPart::pairs);
  auditCandidates();
  adaptTimeStep();
  computeInternalForces();
  limitStepForCompression();
  addLoads(nextLoadSpan());
  sumSharedNodes();
  finish(StepPart::forces);
  enforceContact();
  finish(StepPart::contacts);
  kickVelocities(clock().kickLength());
  finish(StepPart::velocity);
  bookEnergies();
  finish(StepPart::energies);
}

void Simulation::finish(StepPart part) const {
  if (_observer)
    _observer(part);
}

void Simulation::balanceContact() {
  if (_contact)
    _contact->balance(clock().step, _state.displacement);
}

void Simulation::moveNodes() {
  saveStateForGuard();
  const Region region("miniapp::moveNodes");
  // Free bricks drift within their sweep, unless the check of the stable step needs the positions
  // earlier.
  _step.free_bricks_have_drifted = _free_bricks.any() && _steps.checksStability(clock().step + 1);
  drift();
  _has_drifted.set(_space);
  if (_contact)
    _contact->moveSurface(_state.displacement);
  _steps.advance();
}

void Simulation::drift() {
  const bool is_made = _ahead.dt > 0 && _ahead.dt == clock().dt;
  _ahead.dt = 0;
  if (is_made)
    std::swap(_state.displacement, _ahead.displacement);
  else if (_step.free_bricks_have_drifted || movingNodes().all || !host_accessible)
    mechanics::drift(_space, clock().dt, _state);
  else
    mechanics::drift(_space, clock().dt, _state, movingNodes());
}

void Simulation::findContactCandidates() {
  if (!_contact)
    return;
  const Region region("contact::search");
  if (balance().host_counts[deeper_than_boxes] > 0 || _contact->hasGrownTolerance())
    _contact->growSearchTolerance(_step.contact);
  std::function<void()> meanwhile;
  if (!host_accessible && !_step.is_guarded) // the positions are final
    meanwhile = [this] {
      _has_drifted.waitIn(_beside);
      launchInternalForces(_beside);
      _has_forces.set(_beside);
    };
  _contact->findCandidates(!_step.is_guarded, meanwhile);
}

// The velocities decide, before the drift, so that the state can be kept bit for bit.
void Simulation::saveStateForGuard() {
  _step.is_guarded = _contact && balance().fast_nodes > 0;
  if (!_step.is_guarded)
    return;
  View<double* [3]>& displacement = _before_drift.displacement;
  if (displacement.extent(0) != _state.displacement.extent(0))
    displacement = allocate<View<double* [3]>>(
        _space, "miniapp::Simulation::displacement_before_drift", _state.displacement.extent(0));
  Kokkos::deep_copy(_space, displacement, _state.displacement);
  _before_drift.clock = clock();
}

// If a pair has moved by more than contact can resolve, undoes the drift, shortens the step
// permanently and drifts again; or throws PhysicsError on all ranks in the state of the previous
// step.
void Simulation::guardAgainstTunnelling() {
  if (!_step.is_guarded)
    return;
  const Region region("miniapp::guardAgainstTunnelling");
  ++_guarded_steps;
  while (true) {
    const double allowed = _contact->guard().tolerableMotion(clock().dt, !_contact->hasForces());
    const contact::PairMotion fastest =
        _contact->fastestPair(clock().dt_before * _ledger.meanVelocity(), allowed);
    if (!(fastest.motion > allowed))
      return;
    const double dt = clock().dt_before;
    Kokkos::deep_copy(_space, _state.displacement, _before_drift.displacement);
    _steps.restore(_before_drift.clock);
    shortenDrift(_contact->shortenForPair(fastest, dt, clock()));
    _before_drift.clock = clock(); // another round starts from the shortened step
    drift();
    _contact->moveSurfaceAgain(_state.displacement);
    _steps.advance();
    findContactCandidates();
  }
}

// Shortens the next drift and the kick before it: half of the drift's reduction is undone with the
// forces of that kick, as if the length had been known. Only the loads keep their mean over the
// longer kick. The depth of a node is its speed times the reference step, which the guard has
// shortened as well: contacts that become active from here on are stiffer.
void Simulation::shortenDrift(double longest) {
  const double dt = clock().dt;
  if (longest >= dt)
    return;
  _steps.shorten(longest, StepCut::Reason::tunnelling);
  _step.load_span.end = clock().time + 0.5 * clock().dt;
  const double dt_kick = 0.5 * (clock().dt - dt);
  kickVelocities(dt_kick);
  _ledger.bookCorrection(_comm, dt_kick, clock().dt, _step.kick);
  if (balance().failures > 0)
    throw PhysicsError(describeFailure(*this));
}

void Simulation::auditCandidates() {
  if (!_contact || _config.search.audit == 0 || clock().step % _config.search.audit != 0)
    return;
  const Region region("miniapp::auditCandidates");
  _contact->auditCandidates();
}

void Simulation::adaptTimeStep() {
  if (clock().isAtStart() || _steps.isAtEnd() || !_steps.checksStability(clock().step))
    return;
  _steps.shortenIfUnstable(_state.displacement);
}

// They may be under way, launched during the search: kernels that use them wait for _has_forces.
void Simulation::computeInternalForces() {
  if (!_step.awaits_sums)
    launchInternalForces(_space);
}

void Simulation::launchInternalForces(const exec_space& space) {
  _step.has_all_forces = !_free_bricks.any();
  if (_free_bricks.any() && _other_nodes.numRuns() == 0)
    _forces.values = {}; // only output needs them
  else {
    if (_contact && _contact->willStoreAllForces())
      _forces.acts[mechanics::contact_force] = false; // not to be zeroed
    _internal_force->zeroForces(space, _config.viscosity, _forces);
  }
  _forces.acts[mechanics::contact_force] = false;
  const Region region("miniapp::computeInternalForces");
  _step.resting_elems = _resting.numElems();
  _internal_force->launch(space, _state.displacement, _state.velocity, _config.viscosity, _forces,
                          true);
  _step.awaits_sums = true;
}

// What kernels of this step have summed for the host, which has waited for later ones.
void Simulation::takeSums() {
  if (!_step.awaits_sums)
    return;
  _step.awaits_sums = false;
  _step.internal = _internal_force->result(_space);
}

// Quadratic viscosity damps more, and needs a shorter step, the faster elements are compressed.
void Simulation::limitStepForCompression() {
  if (!(_config.viscosity.quadratic > 0) || _steps.isAtEnd())
    return;
  _has_forces.waitIn(_space);
  takeSums();
  const double rate = allReduce(_comm, _step.internal.compression_rate, MPI_MAX);
  if (!_steps.allowForCompression(rate))
    return;
  _steps.shortenIfUnstable(_state.displacement);
}

// A kick spans the time from the exact end of the previous one, so that no part of a pulse is lost
// or counted twice, to the middle of the next step.
mechanics::TimeSpan Simulation::nextLoadSpan() const {
  return {_step.load_span.end, clock().time + 0.5 * clock().dt};
}

void Simulation::addLoads(mechanics::TimeSpan span) {
  const Region region("miniapp::addLoads");
  _step.previous_load_span = _step.load_span;
  _step.load_span = span;
  bool& acts = _forces.acts[mechanics::external_force];
  acts = false;
  for (const auto& load : _loads) {
    acts = acts || load.acts(span);
    if (acts)
      _has_forces.waitIn(_space); // the columns are zeroed with those of the internal forces
    load.launch(_space, _scene.mesh, _state.displacement, span, _forces);
  }
}

// Contacts are selected while the sums travel.
void Simulation::sumSharedNodes() {
  const Region region("miniapp::sumSharedNodes");
  _shared.start(_space, _forces, _has_forces);
  if (_observer || !_contact)
    _shared.finish(_space);
}

void Simulation::enforceContact() {
  if (!_contact)
    return;
  const Region region("miniapp::enforceContact");
  const double dt = clock().isAtStart() ? clock().dt : clock().dt_before;
  _step.contact = _contact->enforce({dt, clock().dt}, _forces, _state, _boundary, _shared);
  _forces.acts[mechanics::contact_force] = _contact->hasForces();
}

// All nodes but those of free bricks and of bodies at rest.
const mechanics::NodeSelection& Simulation::movingNodes() const {
  return _resting.any() ? _resting.movingNodes() : _other_nodes;
}

void Simulation::kickVelocities(double dt_kick) {
  const mechanics::TimeSpan next_drift{clock().time, clock().time + clock().dt};
  {
    const Region region("miniapp::kickVelocities");
    _shared.finish(_space);
    _resting.wake(_space, _forces);
    const TunnellingGuard guard = _contact ? _contact->guard() : TunnellingGuard();
    if (mechanics::can_drift_ahead && !_free_bricks.any()) {
      if (_ahead.displacement.extent(0) != _state.displacement.extent(0))
        _ahead.displacement = allocate<View<double* [3]>>(
            _space, "miniapp::Simulation::displacement_ahead", _state.displacement.extent(0));
      _ahead.dt = movingNodes().numRuns() > 0 ? clock().dt : 0; // otherwise nothing is kicked
    }
    _step.kick =
        mechanics::kick(_space, _scene.mesh, _boundary, next_drift, dt_kick, _forces, _state,
                        _scales, guard.speedTest(_ledger.meanVelocity()), movingNodes(), _ahead);
    takeSums();
    if (_contact)
      _contact->completeSums(_step.contact);
  }
  if (_free_bricks.any())
    stepFreeBricks(dt_kick, next_drift);
}

void Simulation::stepFreeBricks(double dt_kick, const mechanics::TimeSpan& next_drift) {
  const Region region("miniapp::stepFreeBricks");
  const auto sums = _free_bricks.step(_space, _scene.mesh, *_internal_force, _boundary, next_drift,
                                      !_step.free_bricks_have_drifted, clock().dt_before, dt_kick,
                                      _state, _scales);
  _step.internal.energy += sums.internal.energy;
  _step.internal.failure += sums.internal.failure;
  _step.kick += sums.kick;
}

const mechanics::NodalForces& Simulation::forces() {
  if (!_step.has_all_forces) {
    if (_other_nodes.numRuns() == 0)
      allocateForces();
    _internal_force->addSkippedLattices(_space, _state.displacement, _forces);
    _step.has_all_forces = true;
  }
  return _forces;
}

void Simulation::bookEnergies() {
  const Region region("miniapp::bookEnergies");
  _skipped_element_steps += _step.resting_elems;
  mechanics::StepCounts counts;
  mechanics::ContactEnergySums contact_energies;
  _step.load_misfits = 0;
  for (const auto& load : _loads)
    _step.load_misfits += load.misfits(_space);
  counts.failures = _step.contact.failures() + _step.load_misfits;
  if (_contact) {
    _contact->countDeepContacts(_step.contact, counts);
    contact_energies = _contact->energies(_step.contact);
  }
  counts.host[active_contacts] = _step.contact.active();
  counts.host[stop_requests] = _requests.stop;
  counts.host[checkpoint_requests] = _requests.checkpoint;
  _ledger.bookStep(_comm, clock().kickLength(), clock().dt, _step.internal, contact_energies,
                   _step.kick, counts);
  if (balance().failures > 0) {
    const std::string failure = describeFailure(*this);
    stepBack();
    throw PhysicsError(failure);
  }
  if (_contact)
    _contact->addSlip();
}

// Undoes the kick and the drift that led to a failure, so that the last valid state can be written
// with its forces; only those of contact remain. Forces that failed were never added, so the others
// are finite.
void Simulation::stepBack() {
  _ahead.dt = 0;
  const double dt = clock().dt_before;
  undoKickAndDrift(_space, _scene.mesh, _boundary, {clock().time - dt, clock().time},
                   clock().kickLength(), dt, forces(), _state);
  _steps.stepBack();
  computeInternalForces();
  addLoads(_step.previous_load_span);
  sumSharedNodes();
  _shared.finish(_space);
  takeSums();
  forces();
  if (_contact)
    _contact->storeForces(_forces);
  _forces.acts[mechanics::contact_force] = _contact != nullptr;
}

} // namespace brickwall::miniapp
