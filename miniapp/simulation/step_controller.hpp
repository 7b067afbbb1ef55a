// Lengths of the steps: planned at the start and shortened where the deformed bodies, or the
// tunnelling guard, need shorter ones. A step length that changes from step to step would itself be
// unstable (Skeel 1993), so each cut is permanent and large enough to last.
#pragma once

#include "mechanics/force/internal_force.hpp"
#include "mechanics/stability/largest_frequency.hpp"
#include "mechanics/stability/stable_time_step.hpp"
#include "miniapp/scene/scene.hpp"

#include <mpi.h>

#include <vector>

namespace brickwall::miniapp {

// Time and step length.
struct Clock {
  std::int64_t step = 0; // completed steps
  double time = 0; // t^n of the positions
  double dt = 0; // of the next drift
  double dt_before = 0; // of the last drift; 0 at the start

  bool isAtStart() const { return dt_before == 0; }
  // A kick spans half of the steps before and after it; the first one starts at t = 0.
  double kickLength() const { return 0.5 * (dt_before + dt); }
  void advance() {
    dt_before = dt;
    time += dt;
    ++step;
  }
  // The start has no step before it.
  void stepBack() {
    time -= dt_before;
    step = maxOf<std::int64_t>(step - 1, 0);
  }
};

// A reduction of the step length. All later steps keep the new length.
struct StepCut {
  enum class Reason { stability, tunnelling };
  Reason reason = Reason::stability;
  std::int64_t step = 0; // the first with the new length
  double time = 0; // at the beginning of that step
  double from = 0, to = 0; // dt
};

// Effect of the bound on the frequency of whole bodies (time.bound).
struct StepGain {
  double step = 1; // stable step over that of the worst single element, both at rest
  int products = 0; // with the stiffness, to find the bound; 0 with the element bound
  std::int64_t body_types = 0;
};

// One bound of the step: dt = share times the stable step under the load. The step is cut when the
// stable step falls below dt/largest_share.
struct StepLimit {
  // The step allows for this rate of compression. The initial value costs a few per cent of the
  // step.
  mechanics::StabilityTerms load = {{}, 0.01, 0};
  mechanics::ElementsAtRest elements; // under the load, at the start of the run
  mechanics::RestFrequency rest; // of the bodies under the load's contact
  double share = 1, largest_share = 1;
};

// What the lengths of the steps depend on from step to step, for restart files.
struct StepRestart {
  Clock clock;
  double end = 0; // time
  std::int64_t steps_to_end = 0; // total number of steps until `end`
  std::vector<double> rates; // of compression, StepLimit::load
  std::vector<StepCut> cuts;
};

class StepController {
public:
  // `config` and `scene` must outlive the controller.
  StepController(MPI_Comm comm, const Config& config, const Scene& scene)
      : _comm(comm), _config(config), _scene(scene), _end(config.time.end) {}

  // Finds the limits and plans steps of equal length until the end time. Throws InputError if the
  // initial deformation is unstable or if the number of steps is not representable. Collective.
  void plan(mechanics::ElementKind kind, const View<const double* [3]>& displacement);

  const Clock& clock() const { return _clock; }
  // Total number of steps until the end time, or time.steps of the deck.
  std::int64_t plannedSteps() const {
    return minOf(_steps_to_end, _config.time.steps.value_or(_steps_to_end));
  }
  bool isDone() const { return _clock.step >= plannedSteps(); }
  // Whether time.end is reached; a run that ends before, by time.steps, may be continued.
  bool isAtEnd() const { return _clock.step >= _steps_to_end; }
  const StepGain& gain() const { return _gain; }
  const std::vector<StepCut>& cuts() const { return _cuts; }
  bool checksStability(std::int64_t step) const { return step % _config.time.check_interval == 0; }

  void advance() { _clock.advance(); }
  void restore(const Clock& clock) { _clock = clock; }
  void stepBack() { _clock.stepBack(); }

  // Cuts the step if it is too long for the deformed bodies. To be called between drift and kick,
  // so that the kick spans half of either step and the ledger knows the length of the next drift.
  // Collective.
  void shortenIfUnstable(const View<const double* [3]>& displacement);
  // Returns whether the limits now allow for a larger `rate` of compression (of all ranks) than
  // before.
  bool allowForCompression(double rate);
  // Plans steps no longer than `longest` from the present time.
  void shorten(double longest, StepCut::Reason reason);

  // After plan().
  StepRestart restartData() const;
  void restore(const StepRestart& data);
  // Moves the end to `end`, later than the present time, with steps of the present length: the last
  // one ends there or less than a step later.
  void extendTo(double end);

private:
  void setLimits(mechanics::ElementKind kind); // collective
  void findLargestFrequency(mechanics::ElementKind kind, const mechanics::BodyTypes& types,
                            StepLimit& limit); // collective
  double longestStepAtRest();
  double longestStepAtStart(const View<const double* [3]>& displacement); // collective
  void planSteps(double longest);

  MPI_Comm _comm;
  const Config& _config;
  const Scene& _scene;
  exec_space _space;
  Clock _clock;
  double _end = 0; // time
  std::int64_t _steps_to_end = 0; // total number
  std::vector<StepLimit> _limits; // for free bodies; with contact also for bodies in contact
  StepGain _gain;
  std::vector<StepCut> _cuts;
};

} // namespace brickwall::miniapp
