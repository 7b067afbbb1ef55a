// `brickwall run`: the time loop with its output, limits, progress and report.
#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "miniapp/commands/commands.hpp"
#include "miniapp/commands/failure.hpp"
#include "miniapp/output/history.hpp"
#include "miniapp/output/history_columns.hpp"
#include "miniapp/output/output_files.hpp"
#include "miniapp/output/results.hpp"
#include "miniapp/output/run_report.hpp"
#include "miniapp/scene/load_warnings.hpp"
#include "miniapp/simulation/diagnostics.hpp"
#include "miniapp/timing/phase_report.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>

namespace brickwall::miniapp {

namespace {

// True once per interval, at the first step at or after each multiple of it; with interval 0, in
// every step if `always`.
class Ticker {
public:
  Ticker(double interval, bool always) : _interval(interval), _always(always) {}
  bool due(double time) {
    if (_interval <= 0)
      return _always;
    // A step may end a rounding error before the multiple.
    const double tick = std::floor(time / _interval * (1 + 1e-12) + 1e-9);
    if (tick <= _last)
      return false;
    _last = tick;
    return true;
  }

private:
  double _interval;
  bool _always;
  double _last = 0; // a whole number
};

// Wall clock time since the run began.
class WallClock {
public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - _begin).count();
  }
  // Collective: the same on all ranks.
  double agreed(MPI_Comm comm) const { return allReduce(comm, seconds(), MPI_MAX); }

private:
  std::chrono::steady_clock::time_point _begin = std::chrono::steady_clock::now();
};

class Run {
public:
  Run(MPI_Comm comm, const Config& config, const Options& options)
      : _comm(comm), _config(config), _options(options), _recorder(comm, options.timing),
        _scene(makeScene(exec_space(), comm, config)), _simulation(comm, config, _scene),
        _limits(config.limits), _output_ticker(config.output.interval, false),
        _history_ticker(config.output.history_interval, true) {
    _setup_seconds = _clock.seconds();
    for (const std::string& warning : loadWarnings(comm, config, _scene.part))
      _scene.warnings.push_back(warning);
    if (rankOf(_comm) == 0)
      for (const std::string& warning : _scene.warnings)
        std::cout << "warning: " << warning << std::endl;
    if (_options.write_output)
      openOutput();
  }

  int execute() {
    _recorder.watch("contact::search", _simulation.steps().plannedSteps());
    try {
      loop();
    } catch (const PhysicsError& error) {
      // Every rank has the same error and the state of the last good step, which is written and
      // reported as at any other end.
      _breakdown = error.what();
    }
    finishOutput();
    const RunReport report = makeReport();
    if (_options.write_output)
      writeReport(_comm, path("report.json"), report);
    if (rankOf(_comm) == 0) {
      if (!_breakdown.empty())
        printMessage(_breakdown);
      printReport(std::cout, report);
    }
    return report.pass() ? 0 : static_cast<int>(ExitCode::physics);
  }

private:
  void loop() {
    const double begin = _clock.seconds();
    _simulation.start();
    _setup_seconds += _clock.seconds() - begin;
    writeState();
    bool first = true;
    while (!_simulation.isDone()) {
      {
        const Region region("miniapp::step");
        _simulation.step();
      }
      if (first) {
        _recorder.reset();
        _searches_before = numSearches(_simulation);
      } else {
        _recorder.endStep();
      }
      first = false;
      const double time = _simulation.clock().time;
      if (_options.write_output && _history_ticker.due(time))
        writeHistory();
      if (_options.write_output && _output_ticker.due(time))
        writeResults();
      checkLimits();
      if (wallTimeIsUp())
        break;
      printProgress();
    }
  }

  std::string path(const std::string& file) const { return _options.output_directory + "/" + file; }

  void openOutput() {
    makeDirectory(_comm, _options.output_directory);
    removeFile(_comm,
               path("report.json")); // an aborted run must not leave the file of an earlier one
    const std::string base = path(_options.caseName());
    writeTextFile(_comm, base + ".resolved.toml", _config.resolved_deck);
    std::vector<std::string> columns = {"step", "time"};
    const auto names = globalNames(_config);
    columns.insert(columns.end(), names.begin(), names.end());
    _history = std::make_unique<HistoryWriter>(_comm, path("history.csv"), columns);
    _results = std::make_unique<Results>(_comm, base, _config, _scene);
  }

  void writeResults() {
    _results->writeStep(_simulation);
    _last_written = _simulation.clock().step;
  }
  void writeHistory() {
    const Region region("miniapp::output");
    std::vector<double> row = {static_cast<double>(_simulation.clock().step),
                               _simulation.clock().time};
    const auto values = globalValues(_simulation);
    row.insert(row.end(), values.begin(), values.end());
    _history->write(row);
    _last_row = _simulation.clock().step;
  }
  void writeState() {
    if (!_options.write_output)
      return;
    if (_last_row != _simulation.clock().step)
      writeHistory();
    if (_last_written != _simulation.clock().step)
      writeResults();
  }
  void finishOutput() {
    writeState();
    if (_results)
      _results->close();
  }

  void checkLimits() {
    const Clock& clock = _simulation.clock();
    const GaugeValues values = gauges(_simulation);
    for (const std::string& warning : _limits.newWarnings(values, clock.step, clock.time))
      if (rankOf(_comm) == 0)
        std::cout << "warning: " << warning << std::endl;
    warnOfLargeStrain();
    _limits.stopBeyondLimits(values, clock.step, clock.time);
  }

  // Once.
  void warnOfLargeStrain() {
    if (_has_large_strain)
      return;
    const mechanics::NeglectedStrain neglected = neglectedStrain(_simulation);
    _has_large_strain = neglected.strain > mechanics::large_neglected_strain;
    if (!_has_large_strain)
      return;
    const Clock& clock = _simulation.clock();
    char text[300];
    std::snprintf(
        text, sizeof text,
        "element %lld (1-based id %lld) of a linear material has rotated or deformed so far that "
        "the neglected part of its strain, H^T H/2, is %.2g in step %lld (time %.6g): the models "
        "\"svk\" and \"neo_hookean\" describe finite rotations",
        static_cast<long long>(neglected.elem), static_cast<long long>(neglected.elem) + 1,
        neglected.strain, static_cast<long long>(clock.step), clock.time);
    _scene.warnings.push_back(text);
    if (rankOf(_comm) == 0)
      std::cout << "warning: " << text << std::endl;
  }

  bool wallTimeIsUp() {
    constexpr int steps_between_checks = 20;
    if (!_config.limits.wall_time || _simulation.clock().step % steps_between_checks != 0)
      return false;
    _out_of_time = _clock.agreed(_comm) > *_config.limits.wall_time;
    return _out_of_time;
  }

  void printProgress() {
    constexpr double seconds_between_lines = 5;
    if (rankOf(_comm) != 0 || _clock.seconds() - _last_progress < seconds_between_lines)
      return;
    _last_progress = _clock.seconds();
    const auto& clock = _simulation.clock();
    std::printf("step %lld of %lld  time %.4g  energy error %.2e  %.0f s\n",
                static_cast<long long>(clock.step),
                static_cast<long long>(_simulation.steps().plannedSteps()), clock.time,
                _simulation.balance().energy_error, _last_progress);
    std::fflush(stdout);
  }

  RunReport makeReport() {
    RunReport report = runReport(_comm, _config, _scene, _simulation, _recorder);
    report.case_name = _options.caseName();
    report.setup_seconds = allReduce(_comm, _setup_seconds, MPI_MAX);
    report.counted_searches = numSearches(_simulation) - _searches_before;
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
                                std::to_string(_simulation.clock().step) + " steps");
    return report;
  }

  MPI_Comm _comm;
  const Config& _config;
  const Options& _options;
  WallClock _clock;
  PhaseRecorder _recorder;
  Scene _scene;
  Simulation _simulation;
  LimitWatch _limits;
  Ticker _output_ticker, _history_ticker;
  std::unique_ptr<HistoryWriter> _history;
  std::unique_ptr<Results> _results;
  double _setup_seconds = 0; // without output
  std::int64_t _searches_before = 0; // in steps that are not timed
  std::int64_t _last_written = -1, _last_row = -1;
  double _last_progress = 0;
  bool _out_of_time = false;
  bool _has_large_strain = false; // in a linear material
  std::string _breakdown; // why the computation could not continue
};

} // namespace

int runSimulation(MPI_Comm comm, const Config& config, const Options& options) {
  return Run(comm, config, options).execute();
}

} // namespace brickwall::miniapp
