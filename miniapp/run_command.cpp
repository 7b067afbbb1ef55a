// `brickwall run`: the time loop with its output, limits, progress and report.
#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "miniapp/commands.hpp"
#include "miniapp/globals.hpp"
#include "miniapp/history.hpp"
#include "miniapp/phase_report.hpp"
#include "miniapp/report.hpp"
#include "miniapp/results.hpp"
#include "miniapp/search_choice.hpp"
#include "miniapp/simulation.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>

namespace brickwall::miniapp {

namespace {

// True once per interval, at the first step at or after each multiple of it; every step when it is 0 and `always`.
class Ticker {
public:
  Ticker(double interval, bool always) : _interval(interval), _always(always) {}
  bool due(double time) {
    if (_interval <= 0)
      return _always;
    // A step that ends a rounding error before the multiple counts as at it.
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

// Wall clock since the run began, the same on all ranks when asked together.
class WallClock {
public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - _begin).count();
  }
  double agreed(MPI_Comm comm) const { return allReduce(comm, seconds(), MPI_MAX); }

private:
  std::chrono::steady_clock::time_point _begin = std::chrono::steady_clock::now();
};

class Run {
public:
  Run(MPI_Comm comm, const Config& config, const Options& options)
      : _comm(comm), _config(config), _options(options), _recorder(comm, options.timing),
        _scene(makeScene(exec_space(), comm, config)), _simulation(comm, config, _scene),
        _output_ticker(config.output.interval, false),
        _history_ticker(config.output.history_interval, true) {
    if (_options.write_output)
      openOutput();
  }

  int execute() {
    _recorder.watch("search", _simulation.plannedSteps());
    try {
      loop();
    } catch (const PhysicsError& error) {
      // Every rank has the same error and the state of the last good step: written and reported like any other end.
      _breakdown = error.what();
    }
    finishOutput();
    const RunReport report = makeReport();
    if (_options.write_output)
      writeReport(_comm, path("report.json"), report);
    if (rankOf(_comm) == 0) {
      if (!_breakdown.empty())
        std::cerr << "brickwall: " << _breakdown << '\n';
      printReport(std::cout, report);
    }
    return report.pass() ? 0 : static_cast<int>(ExitCode::physics);
  }

private:
  void loop() {
    _simulation.start();
    writeState();
    bool first = true;
    while (!_simulation.done()) {
      {
        const Region region("step");
        _simulation.step();
      }
      if (first)
        _recorder.reset();
      else
        _recorder.endStep();
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
    removeFile(_comm, path("report.json")); // a run that is cut short must not leave another's
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
    const Region region("output");
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
    const auto& balance = _simulation.balance();
    if (balance.energy_error > _config.limits.energy_error)
      throw PhysicsError("energy error " + number(balance.energy_error) + " in step " +
                         std::to_string(_simulation.clock().step) + " (time " +
                         number(_simulation.clock().time) +
                         ") exceeds limits.energy_error = " + number(_config.limits.energy_error));
  }

  bool wallTimeIsUp() {
    constexpr int steps_between_looks = 20;
    if (!_config.limits.wall_time || _simulation.clock().step % steps_between_looks != 0)
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
                static_cast<long long>(_simulation.plannedSteps()), clock.time,
                _simulation.balance().energy_error, _last_progress);
    std::fflush(stdout);
  }

  RunReport makeReport() {
    RunReport report;
    report.case_name = _options.caseName();
    report.title = _config.title;
    report.provenance = describeRun(_comm);
    report.elements = _scene.part.num_global_elems;
    report.nodes = _scene.part.num_global_nodes;
    report.faces = _scene.num_faces;
    report.steps = _simulation.clock().step;
    report.end_time = _simulation.clock().time;
    report.counted_steps = maxOf<std::int64_t>(report.steps - 1, 0);
    const auto slowest = [&](double seconds) { return allReduce(_comm, seconds, MPI_MAX); };
    report.loop_seconds = slowest(_recorder.seconds("step"));
    report.search_seconds = slowest(_recorder.seconds("search"));
    report.solver_seconds = slowest(_recorder.seconds("step") - _recorder.seconds("search") -
                                    _recorder.seconds("step::contact enforcement"));
    report.counted_searches =
        _recorder.calls("findGhosts"); // steps that keep their lists have none
    report.phases = _recorder.phases();
    report.search_timers = _recorder.searchTimers();
    const ContactCounts counts = _simulation.contactCounts();
    report.search.method = nameOf(_config.search.method);
    report.search.margin = _config.search.margin;
    report.search.searches = counts.searches;
    report.search.steps_per_search =
        counts.searches == 0
            ? 0
            : static_cast<double>(counts.updates) / static_cast<double>(counts.searches);
    report.search.seconds_per_step = _recorder.medianPerStep("search");
    report.search.ghost_faces = counts.ghost_faces;
    report.search.candidate_pairs = counts.candidate_pairs;
    report.search.active_contacts = counts.active;
    report.search.audit = _config.contact.enabled ? _config.search.audit : 0;
    report.search.missed_pairs = counts.missed_pairs;
    report.search.drops_same_body = _simulation.dropsSameBody();
    report.time_step = stepReport();
    const auto& balance = _simulation.balance();
    report.balance = {balance.energy_error, balance.momentum_error, balance.external_work,
                      balance.peak_kinetic, balance.peak_stored};
    report.max_rank_bytes = peakRankBytes(_comm);
    if (counts.lost > 0)
      report.warnings.push_back(
          std::to_string(counts.lost) +
          " times a loaded contact was deeper than the search reaches and let go; a larger "
          "contact.tolerance keeps it");
    report.failures = failures();
    return report;
  }

  StepReport stepReport() const {
    StepReport steps;
    const auto& cuts = _simulation.stepCuts();
    steps.last = _simulation.clock().dt;
    steps.first = cuts.empty() ? steps.last : cuts.front().from;
    steps.guarded_steps = _simulation.guardedSteps();
    for (const StepCut& cut : cuts)
      steps.cuts.push_back({cut.reason == StepCut::Reason::tunnelling ? "tunnelling" : "stability",
                            cut.step, cut.time, cut.from, cut.to});
    return steps;
  }

  std::vector<std::string> failures() const {
    std::vector<std::string> failures;
    if (!_breakdown.empty())
      failures.push_back(_breakdown);
    const auto& balance = _simulation.balance();
    if (_config.limits.momentum_error &&
        !(balance.momentum_error <= *_config.limits.momentum_error))
      failures.push_back(
          "momentum error " + number(balance.momentum_error) +
          " exceeds limits.momentum_error = " + number(*_config.limits.momentum_error));
    if (_out_of_time)
      failures.push_back("stopped at limits.wall_time after " +
                         std::to_string(_simulation.clock().step) + " steps");
    return failures;
  }

  static std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
  }

  MPI_Comm _comm;
  const Config& _config;
  const Options& _options;
  WallClock _clock;
  PhaseRecorder _recorder;
  Scene _scene;
  Simulation _simulation;
  Ticker _output_ticker, _history_ticker;
  std::unique_ptr<HistoryWriter> _history;
  std::unique_ptr<Results> _results;
  std::int64_t _last_written = -1, _last_row = -1;
  double _last_progress = 0;
  bool _out_of_time = false;
  std::string _breakdown; // why the computation could not go on
};

} // namespace

int runSimulation(MPI_Comm comm, const Config& config, const Options& options) {
  return Run(comm, config, options).execute();
}

} // namespace brickwall::miniapp
