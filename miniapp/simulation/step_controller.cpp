#include "miniapp/simulation/step_controller.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "miniapp/scene/entity_names.hpp"

#include <cmath>
#include <sstream>

namespace brickwall::miniapp {

namespace {
constexpr double max_steps = 1e15; // also the largest time.steps of a deck
}

void StepController::plan(mechanics::ElementKind kind,
                          const View<const double* [3]>& displacement) {
  setLimits(kind);
  planSteps(longestStepAtStart(displacement));
}

// One limit is for free bodies, the other one for bodies with contact on their whole surface.
// Contact is never that severe, so the second limit keeps little margin for bodies that stiffen as
// they deform. Cuts should be rare, since each changes the energy slightly; bodies are never
// exactly at rest. A step may therefore use half of the margin, and under contact all of it.
void StepController::setLimits(mechanics::ElementKind kind) {
  constexpr double share_in_contact = 0.97;
  const bool bounds_bodies = _config.time.bound != StepBound::element;
  mechanics::BodyTypes types;
  if (bounds_bodies) {
    types = mechanics::findBodyTypes(_space, _comm, _scene.mesh);
    _gain.body_types = types.count;
  }
  const ContactConfig& contact = _config.contact;
  const auto add = [&](double contact_load, double share) {
    StepLimit limit;
    limit.load.viscosity = _config.viscosity;
    limit.load.contact = contact_load;
    limit.load.mass_shares = _scene.mass_shares;
    limit.share = share;
    limit.largest_share = contact_load > 0 ? 1 : 0.5 * (share + 1);
    limit.elements = mechanics::findElementsAtRest(_space, _comm, _scene.mesh, limit.load);
    if (bounds_bodies)
      findLargestFrequency(kind, types, limit);
    _limits.push_back(limit);
  };
  add(0, _config.time.safety);
  if (contact.enabled)
    add(mechanics::contactMassFraction(contact.penalty, contact.damping, contact.edges),
        share_in_contact);
}

void StepController::findLargestFrequency(mechanics::ElementKind kind,
                                          const mechanics::BodyTypes& types, StepLimit& limit) {
  const double contact = limit.load.contact;
  const auto mass = contact > 0 ? mechanics::massUnderContact(_space, _scene.mass,
                                                              _scene.skin.surface_to_node, contact)
                                : _scene.mass;
  const auto found =
      mechanics::largestFrequency(_space, _comm, _scene.mesh, sharedNodes(_scene.part), mass, types,
                                  kind, limit.elements.step_without_viscosity);
  limit.rest = found.bound;
  _gain.products += found.products;
}

// The limits for bodies at rest: the longer of the steps by elements and by whole bodies.
double StepController::longestStepAtRest() {
  double step = HUGE_VAL, by_elements = HUGE_VAL;
  for (const StepLimit& limit : _limits) {
    const auto stable = mechanics::stableTimeStep(limit.elements, limit.load, limit.rest);
    step = minOf(step, limit.share * stable.dt);
    by_elements = minOf(by_elements, limit.share * limit.elements.step.dt);
  }
  _gain.step = step / by_elements;
  return step;
}

// Bodies that start deformed oscillate through their rest state, so both states limit the step.
double StepController::longestStepAtStart(const View<const double* [3]>& displacement) {
  double step = longestStepAtRest();
  if (_config.initial_deformations.empty())
    return step;
  for (const StepLimit& limit : _limits) {
    const auto stable =
        mechanics::stableTimeStep(_space, _comm, _scene.mesh, displacement, limit.load, limit.rest);
    if (!(stable.dt > 0))
      throw InputError("initial.deformation: found " +
                       EntityNames(_comm, _scene.part).element(stable.elem) +
                       " inverted or unstable at the start; expected a smaller gradient");
    step = minOf(step, limit.share * stable.dt);
  }
  return step;
}

// Whole steps of equal length from the present time to the end, none longer than `longest`.
void StepController::planSteps(double longest) {
  const double left = _end - _clock.time;
  const double steps = maxOf(std::ceil(left / longest * (1 - 1e-12)), 1.0);
  _clock.dt = left / steps;
  if (!(_clock.dt > 0)) {
    std::ostringstream message;
    message << "the stable step is " << longest
            << ", and the number of steps until time.end = " << _end
            << " is not representable; expected another density, stiffness or element size";
    throw InputError(message.str());
  }
  _steps_to_end = _clock.step + static_cast<std::int64_t>(minOf(steps, max_steps));
}

StepRestart StepController::restartData() const {
  StepRestart data{_clock, _end, _steps_to_end, {}, _cuts};
  for (const StepLimit& limit : _limits)
    data.rates.push_back(limit.load.rate);
  return data;
}

void StepController::restore(const StepRestart& data) {
  _clock = data.clock;
  _end = data.end;
  _steps_to_end = data.steps_to_end;
  _cuts = data.cuts;
  for (std::size_t i = 0; i < _limits.size(); ++i)
    _limits[i].load.rate = data.rates.at(i);
}

void StepController::extendTo(double end) {
  const double steps = std::ceil((end - _clock.time) / _clock.dt * (1 - 1e-12));
  _end = end;
  _steps_to_end = _clock.step + static_cast<std::int64_t>(minOf(steps, max_steps));
}

void StepController::shorten(double longest, StepCut::Reason reason) {
  StepCut cut;
  cut.reason = reason;
  cut.step = _clock.step + 1;
  cut.time = _clock.time;
  cut.from = _clock.dt;
  planSteps(longest);
  cut.to = _clock.dt;
  _cuts.push_back(cut);
}

void StepController::shortenIfUnstable(const View<const double* [3]>& displacement) {
  const Region region("miniapp::shortenIfUnstable");
  constexpr double reserve = 0.9;
  double longest = _clock.dt;
  for (const StepLimit& limit : _limits) {
    const auto stable =
        mechanics::stableTimeStep(_space, _comm, _scene.mesh, displacement, limit.load, limit.rest,
                                  _clock.dt / limit.largest_share);
    if (limit.largest_share * stable.dt < _clock.dt && stable.dt > 0)
      longest = minOf(longest, reserve * limit.share * stable.dt);
  }
  if (longest < _clock.dt)
    shorten(longest, StepCut::Reason::stability);
}

// A margin of one half keeps the number of changes small for any rate.
bool StepController::allowForCompression(double rate) {
  if (!(rate > _limits[0].load.rate))
    return false;
  for (StepLimit& limit : _limits)
    limit.load.rate = 1.5 * rate;
  return true;
}

} // namespace brickwall::miniapp
