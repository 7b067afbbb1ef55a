// How long the steps of a simulation are: planned at the start, shortened where the deformed bodies ask for it or where a node
// could pass a face within a step. dt jittering from step to step would itself be unstable (Skeel 1993), so each cut is for
// good and by enough to last.
#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "contact/search/audit/pair_motion.hpp"
#include "mechanics/stability/stable_time_step.hpp"
#include "mechanics/step/central_difference.hpp"
#include "miniapp/simulation/simulation.hpp"

#include <cmath>
#include <sstream>

namespace brickwall::miniapp {

// Bodies that fly free, and bodies that are pressed all over their surface. Contact is never that bad, so little is kept there
// for bodies that stiffen as they deform. Cuts should be few, since each changes the energy a little; bodies are never quite
// at rest, so a step may take half of what is kept, and under contact all of it.
void Simulation::setStepLimits() {
  constexpr double most = 0.97; // of the step under contact
  const ContactConfig& contact = _config.contact;
  const auto add = [&](double contact_load, double share) {
    StepLimit limit;
    limit.load.viscosity = _config.viscosity;
    limit.load.contact = contact_load;
    limit.share = share;
    limit.largest_share = contact_load > 0 ? 1 : 0.5 * (share + 1);
    limit.elements = mechanics::findElementsAtRest(_space, _comm, _scene.mesh, limit.load);
    findLargestFrequency(limit);
    _step_limits.push_back(limit);
  };
  add(0, _config.time.safety);
  if (contact.enabled)
    add(mechanics::contactMassFraction(contact.penalty, contact.damping, contact.edges), most);
}

void Simulation::findLargestFrequency(StepLimit& limit) {
  if (_config.time.bound == StepBound::element)
    return;
  const double contact = limit.load.contact;
  const auto mass = contact > 0 ? mechanics::massUnderContact(_space, _scene.mass,
                                                              _scene.skin.surface_to_node, contact)
                                : _scene.mass;
  const auto found =
      mechanics::largestFrequency(_space, _comm, _scene.mesh, sharedNodes(_scene.part), mass,
                                  _internal_force->kind(), limit.elements.step_without_viscosity);
  limit.rest = found.bound;
  _step_gain.products += found.products;
  _step_gain.body_types = found.body_types;
}

// What the limits allow for bodies at rest: the longer of what elements and whole bodies have.
double Simulation::longestStepAtRest() {
  double step = HUGE_VAL, by_elements = HUGE_VAL;
  for (const StepLimit& limit : _step_limits) {
    const auto stable = mechanics::stableTimeStep(limit.elements, limit.load, limit.rest);
    step = minOf(step, limit.share * stable.dt);
    by_elements = minOf(by_elements, limit.share * limit.elements.step.dt);
  }
  _step_gain.step = step / by_elements;
  return step;
}

// Of the bodies as they start, and at rest, through which deformed ones swing.
double Simulation::longestStepAtStart() {
  double step = longestStepAtRest();
  if (_config.initial_deformations.empty())
    return step;
  for (const StepLimit& limit : _step_limits) {
    const auto stable = mechanics::stableTimeStep(_space, _comm, _scene.mesh, _state.displacement,
                                                  limit.load, limit.rest);
    if (!(stable.dt > 0))
      throw InputError(
          "initial.deformation: element " + std::to_string(stable.elem) +
          " (from 0) is inverted or unstable at the start; a smaller gradient is needed");
    step = minOf(step, limit.share * stable.dt);
  }
  return step;
}

// Whole steps of equal length from now to the end, none longer than `longest`.
void Simulation::planSteps(double longest) {
  const double left = _config.time.end - _clock.time;
  constexpr double most = 1e15; // of a deck's time.steps too
  const double steps = maxOf(std::ceil(left / longest * (1 - 1e-12)), 1.0);
  _clock.dt = left / steps;
  if (!(_clock.dt > 0)) {
    std::ostringstream message;
    message << "the stable step is " << longest << ", of which time.end = " << _config.time.end
            << " takes more than a number can say; expected another density, stiffness or size";
    throw InputError(message.str());
  }
  _planned_steps = _clock.step + static_cast<std::int64_t>(minOf(steps, most));
  if (_config.time.steps)
    _planned_steps = minOf(_planned_steps, *_config.time.steps);
}

void Simulation::shortenSteps(double longest, StepCut::Reason reason) {
  StepCut cut;
  cut.reason = reason;
  cut.step = _clock.step + 1;
  cut.time = _clock.time;
  cut.from = _clock.dt;
  planSteps(longest);
  cut.to = _clock.dt;
  _step_cuts.push_back(cut);
}

// Between drift and kick, so that the kick spans half of either step and the ledger knows the drift to come.
void Simulation::adaptTimeStep() {
  if (!checksStableStep(_clock.step) || done())
    return;
  const Region region("step::stable step");
  shortenStepIfUnstable();
}
bool Simulation::checksStableStep(std::int64_t step) const {
  return step % _config.time.check_interval == 0;
}

// Quadratic viscosity damps the more, and needs the shorter a step, the faster elements are compressed. The step allows for
// a rate; when that is exceeded, for half as much again, so that few changes reach any rate. Before the kick, which spans
// half of either step. Collective.
void Simulation::limitStepForCompression() {
  if (!(_config.viscosity.quadratic > 0) || done())
    return;
  const double rate = allReduce(_comm, _internal.compression_rate, MPI_MAX);
  if (!(rate > _step_limits[0].load.rate))
    return;
  for (StepLimit& limit : _step_limits)
    limit.load.rate = 1.5 * rate;
  const Region region("step::stable step");
  shortenStepIfUnstable();
}

void Simulation::shortenStepIfUnstable() {
  constexpr double reserve = 0.9;
  double longest = _clock.dt;
  for (const StepLimit& limit : _step_limits) {
    const auto stable =
        mechanics::stableTimeStep(_space, _comm, _scene.mesh, _state.displacement, limit.load,
                                  limit.rest, _clock.dt / limit.largest_share);
    if (limit.largest_share * stable.dt < _clock.dt && stable.dt > 0)
      longest = minOf(longest, reserve * limit.share * stable.dt);
  }
  if (longest < _clock.dt)
    shortenSteps(longest, StepCut::Reason::stability);
}

// Decided by the velocities, before the drift: then what it starts from can be kept bit for bit.
void Simulation::saveStateForGuard() {
  _is_watched = _coupling && _ledger.balance().fast_nodes > 0;
  if (!_is_watched)
    return;
  if (_kept_displacement.extent(0) != _state.displacement.extent(0))
    _kept_displacement = allocate<View<double* [3]>>(_space, "simulation::kept_displacement",
                                                     _state.displacement.extent(0));
  Kokkos::deep_copy(_space, _kept_displacement, _state.displacement);
  _kept_clock = _clock;
}

void Simulation::guardAgainstTunnelling() {
  if (!_is_watched)
    return;
  const Region region("step::tunnelling guard");
  ++_guarded_steps;
  while (true) {
    const bool is_early = !_enforcement->hasForces();
    const double allowed = _guard.tolerableMotion(_clock.dt, is_early);
    contact::PairMotion fastest = contact::fastestPair(
        _space, _comm, _coupling->surface(), _search->ghosts(), _search->pairs(), allowed);
    if (_edges) {
      const auto fastest_edges = _edges->fastestPair(_space, _comm, allowed);
      if (fastest_edges.motion > fastest.motion)
        fastest = fastest_edges;
    }
    if (!(fastest.motion > allowed))
      return;
    // A throw leaves the state of the step before.
    const double drifted = _clock.dt_before;
    takeBackDrift();
    shortenDrift(_guard.shorten(drifted, fastest, is_early, _clock.step, _clock.time));
    mechanics::drift(_space, _clock.dt, _state);
    _coupling->gatherAgain(_space, _state.displacement);
    _clock.advance();
    findContactCandidates();
  }
}

void Simulation::takeBackDrift() {
  Kokkos::deep_copy(_space, _state.displacement, _kept_displacement);
  _clock = _kept_clock;
}

// The drift to come becomes shorter, and so does the kick that led to its velocity: half of what the drift loses is taken back,
// with the forces of that kick, as if the length had been known; only loads keep their mean over the longer kick. A node's depth
// is its speed times the reference step, so that is shortened too: what is born in contact from now on is stiffer.
void Simulation::shortenDrift(double longest) {
  _enforcement->setReferenceStep(_guard.referenceStep());
  if (_edges)
    _edges->setReferenceStep(_guard.referenceStep());
  const double before = _clock.dt;
  if (longest >= before)
    return;
  shortenSteps(longest, StepCut::Reason::tunnelling);
  _load_span.end = _clock.time + 0.5 * _clock.dt;
  const double dt_kick = 0.5 * (_clock.dt - before);
  kickVelocities(dt_kick);
  _ledger.bookCorrection(_comm, dt_kick, _clock.dt, _kick);
  if (_ledger.balance().failures > 0)
    throw PhysicsError(describeFailure());
}

} // namespace brickwall::miniapp
