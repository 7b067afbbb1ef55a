#include "miniapp/output/run_output.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "io/checkpoint/table_file.hpp"
#include "miniapp/output/history_columns.hpp"
#include "miniapp/output/run_report.hpp"

#include <cmath>
#include <optional>

namespace brickwall::miniapp {

bool Ticker::due(double time) {
  if (_interval <= 0)
    return _always;
  // A step may end a rounding error before the multiple.
  const double tick = std::floor(time / _interval * (1 + 1e-12) + 1e-9);
  if (!(tick < 0x1p53)) // not counted: shorter than any step
    return true;
  if (tick <= _last)
    return false;
  _last = tick;
  return true;
}

RunOutput::RunOutput(MPI_Comm comm, const Config& config, const Scene& scene,
                     const PhaseRecorder& recorder, const std::string& directory,
                     const std::string& case_name, bool writes)
    : _comm(comm), _config(config), _scene(scene), _recorder(recorder), _directory(directory),
      _case_name(case_name), _writes(writes), _output_ticker(config.output.interval, false),
      _history_ticker(config.output.history_interval, true) {}

std::vector<std::string> RunOutput::columns() const {
  std::vector<std::string> columns = {"step", "time"};
  const auto names = globalNames(_config);
  columns.insert(columns.end(), names.begin(), names.end());
  return columns;
}

std::vector<std::string> RunOutput::balanceColumns(const Simulation& simulation) const {
  std::vector<std::string> columns = {"step", "time", "distributions"};
  for (const RankValue& value : loadOfRank(simulation, _recorder))
    for (const char* part : {"_max", "_mean"})
      columns.push_back(value.what + std::string(part));
  return columns;
}

void RunOutput::begin(const Simulation& simulation) {
  if (!_writes)
    return;
  lock();
  create(simulation);
}

void RunOutput::lock() {
  makeDirectory(_comm, _directory);
  if (_config.mesh)
    refuseToReplace(_comm, _config.mesh->file, path(_case_name) + ".exo");
  _lock = FolderLock(_comm, _directory);
  EarlierResults::endReplacement(_comm, path(_case_name) + ".exo");
}

void RunOutput::create(const Simulation& simulation) {
  // An aborted run must not leave the report of an earlier one.
  removeFile(_comm, path("report.json"));
  writeTextFile(_comm, path(_case_name) + ".resolved.toml", _config.resolved_deck);
  _history = std::make_unique<HistoryWriter>(_comm, path("history.csv"), columns());
  if (_config.output.balance)
    _balance =
        std::make_unique<HistoryWriter>(_comm, path("balance.csv"), balanceColumns(simulation));
  _results = std::make_unique<Results>(_comm, path(_case_name), _config, _scene, _recorder);
}

std::string RunOutput::resume(const OutputRestart& data, const Simulation& simulation) {
  if (!_writes)
    return "";
  lock();
  const std::string exodus = path(_case_name) + ".exo";
  const std::string history = path("history.csv");
  const bool has_history = fileExists(_comm, history);
  std::optional<EarlierResults> earlier;
  earlier.emplace(_comm, exodus, static_cast<int>(data.ranks), static_cast<int>(data.exodus_steps),
                  data.exodus_time, resultsConfig(_config));
  std::string problem = earlier->reason();
  if (has_history && problem.empty())
    problem = HistoryWriter::whyNotContinued(_comm, history, columns(), data.history_rows);
  if (has_history && problem.empty() && _config.output.balance)
    problem = HistoryWriter::whyNotContinued(_comm, path("balance.csv"), balanceColumns(simulation),
                                             data.history_rows);
  // Rows precede the checkpoint, but none is in this file: its run was restarted into this folder.
  const bool begins_later = has_history && !problem.empty() && data.history_rows > 0 &&
                            HistoryWriter::firstStep(_comm, history) > simulation.clock().step;
  if (!problem.empty() && !begins_later)
    throw InputError(
        "the results in " + _directory +
        " are not those that the checkpoint continues: " + problem +
        ". Either may be of another run in this folder; move the results away, or name "
        "another folder with -o, to begin new files");
  _history_ticker.restore(data.history_tick);
  _output_ticker.restore(data.output_tick);
  if (begins_later || (!has_history && !earlier->isFound())) {
    earlier.reset(); // closes the files
    create(simulation);
    return (begins_later
                ? "the results in " + _directory + " begin after the checkpoint and are replaced"
                : "found no results of the earlier run in " + _directory) +
           ": history.csv and the Exodus file begin at the checkpoint";
  }
  if (!has_history || !earlier->isFound())
    throw InputError("the results in " + _directory + " are not complete: there is no " +
                     (has_history ? exodus : history));
  removeFile(_comm, path("report.json"));
  writeTextFile(_comm, path(_case_name) + ".resolved.toml", _config.resolved_deck);
  _results =
      std::make_unique<Results>(_comm, path(_case_name), _config, _scene, _recorder, *earlier);
  _history = std::make_unique<HistoryWriter>(_comm, history, columns(), data.history_rows);
  if (_config.output.balance)
    _balance = std::make_unique<HistoryWriter>(_comm, path("balance.csv"),
                                               balanceColumns(simulation), data.history_rows);
  _last_row = data.last_row;
  _last_written = data.last_written;
  _last_time = data.exodus_time;
  return "";
}

void RunOutput::writeDue(Simulation& simulation) {
  const double time = simulation.clock().time;
  if (_writes && _history_ticker.due(time))
    writeHistory(simulation);
  if (_writes && _output_ticker.due(time))
    writeResults(simulation);
}

void RunOutput::writeState(Simulation& simulation) {
  if (!_writes)
    return;
  if (_last_row != simulation.clock().step)
    writeHistory(simulation);
  if (_last_written != simulation.clock().step)
    writeResults(simulation);
}

void RunOutput::writeHistory(const Simulation& simulation) {
  const Region region("miniapp::output");
  std::vector<double> row = {static_cast<double>(simulation.clock().step), simulation.clock().time};
  const auto values = globalValues(simulation);
  row.insert(row.end(), values.begin(), values.end());
  _history->write(row);
  if (_balance)
    writeBalance(simulation);
  _last_row = simulation.clock().step;
}

// Seconds are those since the row before; the recorder begins anew after the first step.
void RunOutput::writeBalance(const Simulation& simulation) {
  std::vector<RankValue> load = loadOfRank(simulation, _recorder);
  const std::size_t num_counts = countsOfRank(simulation).size();
  _last_seconds.resize(load.size(), 0);
  for (std::size_t i = num_counts; i < load.size(); ++i) {
    const double seconds = load[i].here;
    load[i].here -= seconds >= _last_seconds[i] ? _last_seconds[i] : 0;
    _last_seconds[i] = seconds;
  }
  reduceOverRanks(_comm, load);
  const ContactStep* contact = simulation.contact();
  std::vector<double> row = {static_cast<double>(simulation.clock().step), simulation.clock().time,
                             contact ? static_cast<double>(contact->distributions()) : 0};
  for (const RankValue& value : load)
    row.insert(row.end(), {value.max, value.mean});
  _balance->write(row);
}

void RunOutput::writeResults(Simulation& simulation) {
  _results->writeStep(simulation);
  _last_written = simulation.clock().step;
  _last_time = simulation.clock().time;
}

void RunOutput::followElements() {
  if (!_results)
    return;
  _results->close();
  const EarlierResults earlier(_comm, path(_case_name) + ".exo", sizeOf(_comm),
                               _results->numSteps(), _last_time, resultsConfig(_config));
  if (!earlier.isFound())
    throw OutputError("the Exodus files cannot follow the elements to other ranks: " +
                      earlier.reason());
  _results.reset();
  _results =
      std::make_unique<Results>(_comm, path(_case_name), _config, _scene, _recorder, earlier);
}

void RunOutput::close() {
  if (_results)
    _results->close();
}

void RunOutput::sync() const {
  if (!_results)
    return;
  rethrowOnAllRanks(_comm, [&] {
    io::syncToDisk(_results->fileName());
    if (rankOf(_comm) == 0) {
      io::syncToDisk(path("history.csv"));
      if (_balance)
        io::syncToDisk(path("balance.csv"));
      io::syncToDisk(_directory);
    }
  });
}

OutputRestart RunOutput::restartData() const {
  OutputRestart data;
  data.ranks = sizeOf(_comm);
  data.history_rows = _history ? _history->numRows() : 0;
  data.exodus_steps = _results ? _results->numSteps() : 0;
  data.exodus_time = _last_time;
  data.last_row = _last_row;
  data.last_written = _last_written;
  data.history_tick = _history_ticker.last();
  data.output_tick = _output_ticker.last();
  return data;
}

} // namespace brickwall::miniapp
