// When a run writes checkpoints, and what is known of the last one.
#pragma once

#include "miniapp/commands/command_line.hpp"
#include "miniapp/restart/checkpoints.hpp"

#include <mpi.h>

#include <cstdint>
#include <string>

namespace brickwall::miniapp {

class RunCheckpoints {
public:
  // All arguments must outlive the object.
  RunCheckpoints(MPI_Comm comm, const Config& config, const Scene& scene, const Options& options)
      : _config(config.checkpoint), _options(options),
        _checkpoints(comm, config, scene, options.output_directory) {}

  // The one of --restart. Collective; see Checkpoints::read().
  RunRestart read(const Simulation& simulation) {
    return _checkpoints.read(_options.restart, simulation);
  }

  // Whether checkpoint.minutes have passed since the last one, `now` s after the start of the run.
  bool isDueAt(double now) const {
    return _config.minutes && now - _last_time >= 60 * *_config.minutes;
  }
  // Whether checkpoint.steps asks for one after this step.
  bool isDueAfter(std::int64_t step) const {
    return _config.steps && step > 0 && step % *_config.steps == 0;
  }
  // Whether that of this step is still to be written, if the run writes anything.
  bool isMissing(std::int64_t step) const { return _options.write_output && _last_step != step; }

  // Writes one, `now` s after the start, once the results so far are on the disk. Returns its path,
  // or "" if that failed, which is no error while the run goes on. Collective.
  std::string write(const RunRestart& data, const RunOutput& results, const Simulation& simulation,
                    double now) {
    _last_time = now;
    _last_step = simulation.clock().step;
    _failure.clear();
    try {
      results.sync();
      return _checkpoints.write(data, simulation);
    } catch (const OutputError& error) {
      _failure = error.what();
      return "";
    }
  }
  // Why the last one could not be written, or "".
  const std::string& failure() const { return _failure; }
  // After which the last one was written; -1: none, or a failure.
  std::int64_t lastStep() const { return _failure.empty() ? _last_step : -1; }

private:
  const CheckpointConfig& _config;
  const Options& _options;
  Checkpoints _checkpoints;
  double _last_time = 0; // s
  std::int64_t _last_step = -1; // written or tried
  std::string _failure;
};

} // namespace brickwall::miniapp
