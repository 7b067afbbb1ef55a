// `brickwall run`: the time loop with its output, limits, progress and report.
#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "miniapp/commands/commands.hpp"
#include "miniapp/commands/run_checkpoints.hpp"
#include "miniapp/commands/run_signals.hpp"
#include "miniapp/output/progress.hpp"
#include "miniapp/output/run_output.hpp"
#include "miniapp/output/run_report.hpp"
#include "miniapp/restart/element_move.hpp"
#include "miniapp/scene/load_warnings.hpp"
#include "miniapp/scene/magnitudes.hpp"
#include "miniapp/simulation/diagnostics.hpp"
#include "miniapp/simulation/element_balance.hpp"
#include "miniapp/timing/phase_recorder.hpp"
#include "miniapp/timing/stopwatch.hpp"

#include <cstdio>
#include <iostream>
#include <memory>

namespace brickwall::miniapp {

namespace {

// Ends the run early, without a failure.
constexpr int stopped_code = 5;

class Run {
public:
  Run(MPI_Comm comm, const Config& config, const Options& options)
      : _comm(comm), _config(config), _options(options),
        _progress(rankOf(comm) == 0 ? Progress::chooseStyle(options.quiet) : Progress::Style::none),
        _recorder(comm, options.timing), _scene(makeScene(exec_space(), comm, config)),
        _simulation(std::make_unique<Simulation>(comm, config, _scene)), _limits(config.limits),
        _checkpoints(comm, config, _scene, options),
        _output(comm, config, _scene, _recorder, options.output_directory, options.caseName(),
                options.write_output),
        _setup_seconds(_clock.seconds()), _element_balance(comm, config.partition, _setup_seconds) {
    const double dt = _simulation->clock().dt;
    for (const auto& warnings : {loadWarnings(comm, config, _scene.part, dt),
                                 absurdMagnitudes(config, magnitudesOf(comm, config, _scene, dt),
                                                  _simulation->steps().plannedSteps())})
      _scene.warnings.insert(_scene.warnings.end(), warnings.begin(), warnings.end());
    for (const std::string& warning : _scene.warnings)
      print("warning: " + warning);
    if (_options.restart.empty())
      _output.begin(*_simulation);
    else
      resume();
  }

  int execute() {
    if (_is_complete) {
      print("the run is complete: it has reached its end at step " + presentStep() +
            "; --extend-to, or a larger time.steps, continues it");
      return 0;
    }
    _recorder.watch("contact::search", _simulation->steps().plannedSteps());
    observe();
    try {
      loop();
    } catch (const PhysicsError& error) {
      // Every rank has the same error and the state of the last good step, which is written and
      // reported as at any other end.
      _breakdown = error.what();
      if (!_checksums.empty())
        print("checksums of the step that failed:" + _checksums);
    }
    writeLastState();
    _progress.clear();
    _output.close();
    const RunReport report = makeReport();
    giveToAdiak(_comm, report);
    if (_options.write_output)
      writeTextFile(_comm, _output.path("report.json"), reportJson(report));
    if (rankOf(_comm) == 0)
      printReport(std::cout, report, _options.quiet);
    if (!_checkpoints.failure().empty() && report.failures.empty())
      throw OutputError(_checkpoints.failure());
    return report.pass()             ? 0
           : report.failures.empty() ? stopped_code
                                     : static_cast<int>(ExitCode::physics);
  }

private:
  void resume() {
    const RunRestart data = _checkpoints.read(*_simulation);
    _simulation->restore(data.simulation);
    _first_step = _simulation->clock().step;
    if (_options.extend_to)
      extendTo(*_options.extend_to);
    _limits.restore(data.reported_limits, data.warnings);
    _has_large_strain = data.has_large_strain;
    printUnlessQuiet("restarted at step " + presentStep());
    _is_complete = _simulation->isDone();
    if (_is_complete)
      return;
    for (const std::string& warning : {data.note, _output.resume(data.output, *_simulation)})
      if (!warning.empty()) {
        _scene.warnings.push_back(warning);
        print("warning: " + warning);
      }
  }

  void extendTo(double end) {
    const double time = _simulation->clock().time;
    if (!(end > time))
      throw InputError("--extend-to: found " + format("%.9g", end) +
                       ", expected a time after that of the checkpoint, " + format("%.9g", time));
    _simulation->extendTo(end);
  }

  void loop() {
    const double begin = _clock.seconds();
    if (_options.restart.empty()) {
      makeRequests();
      _simulation->start();
      _setup_seconds += _clock.seconds() - begin;
      _output.writeState(*_simulation);
      if (obeyRequests())
        return;
    }
    _loop_begin = _clock.seconds();
    bool first = true;
    while (!_simulation->isDone()) {
      {
        const Region region("miniapp::step");
        if (!first)
          rebalance();
        makeRequests();
        _simulation->step();
      }
      if (first) {
        _recorder.reset();
        _searches_before = numSearches(*_simulation);
        _sent_before = messagesSent();
      } else {
        _recorder.endStep();
      }
      first = false;
      _output.writeDue(*_simulation);
      checkLimits();
      if (obeyRequests() || wallTimeIsUp())
        break;
      printProgress();
    }
  }

  void observe() {
    if (_options.checksums)
      _simulation->observe([this](StepPart part) { addChecksum(part); });
  }

  // Moves elements to other ranks if that pays (partition.rebalance).
  void rebalance() {
    const auto ranks = _element_balance.newRanks(*_simulation, partSeconds());
    if (!ranks)
      return;
    const Stopwatch time;
    const std::string present = presentStep();
    try {
      const Region region("miniapp::rebalance");
      _simulation = moveElements(std::move(_simulation), _scene, *ranks);
      observe();
      _output.followElements();
    } catch (const Error& error) {
      // There may be no state to write, as after errors of steps. The deck has been accepted
      // before.
      std::string how;
      if (_checkpoints.lastStep() >= 0)
        how = format("; --restart latest continues at step %lld", _checkpoints.lastStep());
      throw Error(error.code() == ExitCode::bad_input ? ExitCode::internal : error.code(),
                  "elements could not be moved to other ranks after step " + present + ": " +
                      error.what() + how);
    }
    const double seconds = allReduce(_comm, time.seconds(), MPI_MAX);
    PartSeconds now = partSeconds();
    now.step += seconds; // as soon as the region of this step ends
    _element_balance.haveMoved(seconds, now);
  }

  PartSeconds partSeconds() const {
    const auto seconds = [this](const char* region) { return _recorder.seconds(region); };
    return {seconds("miniapp::step"),
            seconds("miniapp::computeInternalForces") + seconds("miniapp::kickVelocities") +
                seconds("miniapp::stepFreeBricks"),
            seconds("contact::search") + seconds("miniapp::enforceContact")};
  }

  // Signals may reach any rank; the clock is that of rank 0.
  void makeRequests() {
    Requests requests;
    _stop_signal = _signals.stop();
    requests.checkpoint = _signals.takeCheckpoint();
    if (rankOf(_comm) == 0) {
      const double now = _clock.seconds();
      _is_time_up = _options.time_limit && now >= *_options.time_limit;
      requests.checkpoint |= _checkpoints.isDueAt(now);
    }
    requests.stop = !_stop_signal.empty() || _is_time_up;
    _simulation->request(requests);
  }

  // What all ranks have agreed on in the step. Returns whether the run is to end.
  bool obeyRequests() {
    const Requests requests = _simulation->requests();
    if (requests.stop && !_simulation->isDone()) {
      const std::string reason = _is_time_up            ? "--time-limit"
                                 : _stop_signal.empty() ? "a signal"
                                                        : _stop_signal;
      _stopped = "ended by " + broadcast(_comm, reason) + " after step " + presentStep() +
                 (_options.write_output ? "; --restart latest continues the run" : "");
      return true;
    }
    const bool is_due = requests.checkpoint || _checkpoints.isDueAfter(_simulation->clock().step);
    if (is_due && _simulation->isDone())
      _wants_last_checkpoint = true;
    else if (is_due)
      writeCheckpoint(_output.restartData());
    return false;
  }

  // The checkpoint of a complete run follows its last state, which no restart writes again; that of
  // another run precedes it, since little time may be left. A run that is continued drops the
  // state.
  void writeLastState() {
    const OutputRestart continued = _output.restartData();
    const bool is_done = _simulation->isDone();
    if (is_done)
      _output.writeState(*_simulation);
    if (_breakdown.empty() &&
        (_config.checkpoint.any() || _wants_last_checkpoint || !_stopped.empty() || _out_of_time))
      writeCheckpoint(continued);
    if (!is_done)
      _output.writeState(*_simulation);
  }

  void writeCheckpoint(const OutputRestart& output) {
    if (!_checkpoints.isMissing(_simulation->clock().step))
      return;
    const Region region("miniapp::checkpoint");
    const RunRestart data{_simulation->restartData(), output, _limits.reported(), _has_large_strain,
                          _limits.warnings(),         ""};
    const std::string path = _checkpoints.write(data, _output, *_simulation, _clock.seconds());
    if (_checkpoints.failure().empty())
      printUnlessQuiet("checkpoint " + path);
    else
      print("warning: no checkpoint: " + _checkpoints.failure());
  }

  std::string presentStep() const {
    const Clock& clock = _simulation->clock();
    return format("%lld of %lld, time %.9g", clock.step, _simulation->steps().plannedSteps(),
                  clock.time);
  }

  // Prints a line at the end of the step.
  void addChecksum(StepPart part) {
    const auto sum = static_cast<unsigned long long>(checksumOf(*_simulation, part));
    _checksums += format(" %s=%016llx", nameOf(part), sum);
    if (part != StepPart::energies)
      return;
    print(format("checksums step=%lld", _simulation->clock().step) + _checksums);
    _checksums.clear();
  }

  void print(const std::string& line) {
    _progress.clear();
    if (rankOf(_comm) == 0)
      std::cout << line << std::endl;
  }
  void printUnlessQuiet(const std::string& line) {
    if (!_options.quiet)
      print(line);
  }

  void checkLimits() {
    const Clock& clock = _simulation->clock();
    const GaugeValues values = gauges(*_simulation);
    for (const std::string& warning : _limits.newWarnings(values, clock.step, clock.time))
      print("warning: " + warning);
    warnOfLargeStrain();
    _limits.stopBeyondLimits(values, clock.step, clock.time);
  }

  // Once.
  void warnOfLargeStrain() {
    if (_has_large_strain)
      return;
    const std::string warning = largeStrainWarning(*_simulation);
    _has_large_strain = !warning.empty();
    if (!_has_large_strain)
      return;
    _limits.keep(warning); // checkpoints hold these
    print("warning: " + warning);
  }

  bool wallTimeIsUp() {
    constexpr int steps_between_checks = 20;
    if (!_config.limits.wall_time || _simulation->clock().step % steps_between_checks != 0)
      return false;
    _out_of_time = allReduce(_comm, _clock.seconds(), MPI_MAX) > *_config.limits.wall_time;
    return _out_of_time;
  }

  void printProgress() {
    const auto& clock = _simulation->clock();
    _progress.show({clock.step, _simulation->steps().plannedSteps(), _first_step, clock.time,
                    _clock.seconds() - _loop_begin, _simulation->balance().energy_error,
                    _simulation->balance().host_counts[active_contacts]});
  }

  RunReport makeReport() {
    RunReport report = runReport(_comm, _config, _scene, *_simulation, _recorder);
    report.rebalancings = _element_balance.rebalancings();
    report.case_name = _options.caseName();
    if (_options.checksums)
      report.options.push_back("--checksums");
    if (_options.timing == Timing::paper)
      report.options.push_back("--timing paper");
    report.first_step = _first_step;
    report.counted_steps = maxOf<std::int64_t>(report.counted_steps - _first_step, 0);
    addMessages(_comm, _sent_before, report);
    report.stopped = _stopped;
    report.setup_seconds = allReduce(_comm, _setup_seconds, MPI_MAX);
    report.counted_searches = numSearches(*_simulation) - _searches_before;
    report.warnings.insert(report.warnings.begin(), _limits.warnings().begin(),
                           _limits.warnings().end());
    report.warnings.insert(report.warnings.begin(), _scene.warnings.begin(), _scene.warnings.end());
    report.warnings.insert(report.warnings.begin(), _config.warnings.begin(),
                           _config.warnings.end());
    report.printed_warnings =
        _config.warnings.size() + _scene.warnings.size() + _limits.warnings().size();
    if (!_breakdown.empty())
      report.failures.push_back(_breakdown);
    if (_out_of_time)
      report.failures.push_back("stopped at limits.wall_time after " +
                                std::to_string(_simulation->clock().step) + " steps");
    return report;
  }

  MPI_Comm _comm;
  const Config& _config;
  const Options& _options;
  RunSignals _signals;
  Stopwatch _clock;
  Progress _progress;
  PhaseRecorder _recorder;
  Scene _scene;
  std::unique_ptr<Simulation> _simulation;
  LimitWatch _limits;
  RunCheckpoints _checkpoints;
  RunOutput _output;
  double _setup_seconds; // without output
  ElementBalance _element_balance;
  std::int64_t _searches_before = 0; // in steps that are not timed
  MessageCounts _sent_before; // likewise
  std::int64_t _first_step = 0; // of a restarted run
  double _loop_begin = 0; // s
  std::string _checksums; // of the present step, as text
  std::string _stop_signal; // of this rank
  bool _is_time_up = false; // on rank 0
  std::string _stopped; // why the run ends early
  bool _wants_last_checkpoint = false; // one was due or requested in the last step
  bool _is_complete = false; // a restart with nothing left to do
  bool _out_of_time = false;
  bool _has_large_strain = false; // in a linear material
  std::string _breakdown; // why the computation could not continue
};

} // namespace

int runSimulation(MPI_Comm comm, const Config& config, const Options& options) {
  return Run(comm, config, options).execute();
}

} // namespace brickwall::miniapp
