// The files that a run writes while it goes: history.csv, with output.balance also balance.csv, and
// Exodus steps, each at its interval.
#pragma once

#include "miniapp/output/history.hpp"
#include "miniapp/output/output_files.hpp"
#include "miniapp/output/results.hpp"

#include <memory>
#include <string>
#include <vector>

namespace brickwall::miniapp {

// True once per interval, at the first step at or after each multiple of it; with interval 0, in
// every step if `always`.
class Ticker {
public:
  Ticker(double interval, bool always) : _interval(interval), _always(always) {}
  bool due(double time);
  double last() const { return _last; }
  void restore(double last) { _last = last; }

private:
  double _interval;
  bool _always;
  double _last = 0; // a whole number
};

// What was written before a checkpoint, for the restart file.
struct OutputRestart {
  std::int64_t ranks = 1; // that wrote the files
  std::int64_t history_rows = 0, exodus_steps = 0;
  double exodus_time = 0; // of the last step
  std::int64_t last_row = -1, last_written = -1; // steps of the run
  double history_tick = 0, output_tick = 0; // Ticker::last()
};

class RunOutput {
public:
  // Writes nothing if `writes` is false. `recorder`: see Results.
  RunOutput(MPI_Comm comm, const Config& config, const Scene& scene, const PhaseRecorder& recorder,
            const std::string& directory, const std::string& case_name, bool writes);

  // Creates the folder and new files. Collective. Throws OutputError on all ranks.
  void begin(const Simulation& simulation);
  // Continues the files of an earlier run from the rows and steps of a checkpoint on; begins new
  // files if there are none. Collective. Throws OutputError on all ranks, and InputError if there
  // are files that do not belong to the checkpoint: they are left as they are. Returns a warning,
  // or "".
  std::string resume(const OutputRestart& data, const Simulation& simulation);

  // Writes what is due after a step. Collective.
  void writeDue(Simulation& simulation);
  // Writes the present state if it is not written yet. Collective.
  void writeState(Simulation& simulation);
  // To be called when elements have moved to other ranks, which the scene knows: copies the Exodus
  // steps so far to files of the new parts. Collective. Throws OutputError on all ranks.
  void followElements();
  void close(); // collective
  // Waits until all that is written is on the disk. Collective. Throws OutputError on all ranks.
  void sync() const;

  std::string path(const std::string& file) const { return _directory + "/" + file; }
  OutputRestart restartData() const;

private:
  void lock();
  void create(const Simulation& simulation);
  std::vector<std::string> columns() const;
  std::vector<std::string> balanceColumns(const Simulation& simulation) const;
  void writeHistory(const Simulation& simulation);
  void writeBalance(const Simulation& simulation);
  void writeResults(Simulation& simulation);

  MPI_Comm _comm;
  const Config& _config;
  const Scene& _scene;
  const PhaseRecorder& _recorder;
  std::string _directory, _case_name;
  bool _writes;
  FolderLock _lock;
  Ticker _output_ticker, _history_ticker;
  std::unique_ptr<HistoryWriter> _history, _balance;
  std::vector<double> _last_seconds; // of this rank, at the last row of balance.csv
  std::unique_ptr<Results> _results;
  std::int64_t _last_written = -1, _last_row = -1;
  double _last_time = 0; // of the last Exodus step
};

} // namespace brickwall::miniapp
