// What a simulation tells, and the state that it goes back to, when a step fails.
#include "contact/base/mpi.hpp"
#include "mechanics/step/undo_step.hpp"
#include "miniapp/scene/entity_names.hpp"
#include "miniapp/simulation/simulation.hpp"

#include <sstream>

namespace brickwall::miniapp {

// Undoes the kick and the drift that led to a failed element, so that the last good state can be written, with its
// forces; only those of contact stay as they are. Forces that failed were never added, so what was added is finite. The
// start has no drift and no step before it.
void Simulation::stepBack(double dt_kick) {
  undoKickAndDrift(_space, _scene.mesh, _boundary, {_clock.time - _clock.dt_before, _clock.time},
                   dt_kick, _clock.dt_before, forces(), _state);
  _clock.time -= _clock.dt_before;
  _clock.step = maxOf<std::int64_t>(_clock.step - 1, 0);
  computeInternalForces();
  addLoads(_load_span_before);
  sumSharedNodes();
  forces();
  if (_coupling)
    _coupling->storeContactForces(_space, _enforcement->touched(), _enforcement->forces(), _forces);
}

std::string Simulation::describeFailure() {
  std::ostringstream message;
  const auto failure = mechanics::agreeOnFailure(_space, _comm, _scene.mesh, _internal.failure);
  auto contact_sums = _contact;
  contact::sumOverRanks(_comm, contact_sums.nodes);
  contact::sumOverRanks(_comm, contact_sums.edges);
  message << "the computation broke down in step " << _clock.step << " (time " << _clock.time
          << "): ";
  if (failure.count > 0)
    message << mechanics::describe(failure);
  else if (contact_sums.failures() > 0)
    message
        << (contact_sums.nodes.failures() > 0 ? contact_sums.nodes : contact_sums.edges).problem()
        << (contact_sums.nodes.invalid + contact_sums.edges.invalid > 0 ? describeLargestForce()
                                                                        : "");
  else
    message << "a load or an energy is not finite or beyond the range of the exact sums";
  return message.str();
}

std::string Simulation::describeLargestForce() {
  contact::LargestForce largest =
      contact::largestForce(_space, _comm, _coupling->surface(), _enforcement->history());
  if (_edges) {
    const contact::LargestForce of_edges = _edges->largestForce(_space, _comm);
    if (of_edges.force > largest.force)
      largest = of_edges;
  }
  if (!(largest.force > 0))
    return "";
  const auto body = [&](global_id id) { return bodyName(_comm, _config, _scene.part, id); };
  const double range = contact::largestPairForce(_forces.quantum);
  std::ostringstream message;
  message << "; the largest, " << largest.force << ", is that of "
          << (largest.is_of_edges ? edgeName(largest.node) : nodeName(largest.node)) << " of "
          << body(largest.node_body) << " and "
          << (largest.is_of_edges ? edgeName(largest.face) : faceName(largest.face)) << " of "
          << body(largest.face_body) << ". The range ends at " << range
          << ", by (lambda + 2 mu) h^2 of the strongest element";
  if (largest.force < HUGE_VAL)
    message << ". " << cureOf(largest.force / range);
  return message.str();
}

// A node of mass m that comes with speed v is stopped by sqrt(k m) v = sqrt(s) m v/dt, for k = s m/dt^2 with s contact.penalty: half the
// range bears that with s (range/(2 F))^2.
std::string Simulation::cureOf(double excess) const {
  std::ostringstream message;
  for (const StepCut& cut : _step_cuts)
    if (cut.reason == StepCut::Reason::tunnelling) {
      message << "The step was cut, from " << cut.from
              << ", so that nodes are stopped within contact.tolerance: raise that, or slow the "
                 "bodies down";
      return message.str();
    }
  const double part = minOf(0.5 / excess, 1.0);
  message.precision(1);
  message << "Contact is the stiffer, k = contact.penalty m/dt^2, the shorter the step: let it be "
             "longer (time.safety, the size of the smallest elements), or soften contact by "
             "contact.penalty = "
          << _config.contact.penalty * part * part;
  return message.str();
}

} // namespace brickwall::miniapp
