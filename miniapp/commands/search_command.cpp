// `brickwall search`: the global and local search alone on the wall's moving surface, repeated.
#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "contact/search/candidate_search.hpp"
#include "io/wall/shuffle_surface.hpp"
#include "io/wall/wall_generator.hpp"
#include "miniapp/commands/commands.hpp"
#include "miniapp/deck/words.hpp"
#include "miniapp/output/output_files.hpp"
#include "miniapp/output/search_report.hpp"
#include "miniapp/scene/scene.hpp"
#include "miniapp/scene/search_surface.hpp"
#include "miniapp/timing/phase_recorder.hpp"
#include "miniapp/timing/process_memory.hpp"

#include <algorithm>
#include <iostream>

namespace brickwall::miniapp {

namespace {

double shortestEdge(const WallConfig& wall) {
  double shortest = wall.brick[0];
  for (int d = 0; d < 3; ++d)
    shortest = std::min(shortest, wall.brick[d] / static_cast<double>(wall.elements[d]));
  return shortest;
}

class SearchRun {
public:
  SearchRun(MPI_Comm comm, const Config& config, const Options& options)
      : _comm(comm), _config(config), _options(options), _recorder(comm, options.timing),
        _edge(shortestEdge(*config.wall)), _moving(makeSurface()),
        _search(comm, searchConfig(config, config.contact.tolerance * _edge, false),
                margin() * _edge) {}

  int execute() {
    const std::string file = _options.output_directory + "/search.json";
    if (_options.write_output) {
      makeDirectory(_comm, _options.output_directory);
      removeFile(_comm, file); // an aborted run must not leave the file of an earlier one
    }
    watchPhases();
    const MemoryAbove memory;
    searchRepeatedly();
    const SearchOnlyReport report = makeReport(memory);
    if (_options.write_output)
      writeTextFile(_comm, file, searchReportJson(report));
    if (rankOf(_comm) == 0)
      printSearchReport(std::cout, report);
    return 0;
  }

private:
  // Each repetition searches unless the deck gives a margin.
  double margin() const { return _config.search.has_margin ? _config.search.margin : 0; }
  // The copy of the surface on the host is freed here: it does not belong to the memory of the
  // search.
  SearchSurface makeSurface() {
    const SearchConfig& search = _config.search;
    const auto seed = static_cast<std::uint64_t>(search.seed);
    auto part = io::generateWallSurface(_comm, *_config.wall, io::WallJitter{search.jitter, seed});
    if (search.shuffle)
      io::shuffleSurface(seed, part);
    _num_nodes = part.num_global_nodes;
    _num_faces = part.num_global_faces;
    return SearchSurface(_space, part, rankOf(_comm), search.drift * _edge, seed);
  }

  void watchPhases() {
    const std::int64_t searches = _config.search.repetitions;
    for (const char* region : {whole, global, local})
      _recorder.watch(region, searches);
    _recorder.watchCpu({whole, global, local}, searches);
    _recorder.watchSearchTimers(searches);
  }

  void searchRepeatedly() {
    const std::int64_t steps = _config.search.warmup + _config.search.repetitions;
    for (std::int64_t step = 0; step < steps; ++step) {
      if (step == _config.search.warmup) {
        _recorder.reset();
        _searches_before = _search.searches();
      }
      _moving.move(_space, step);
      _space.fence();
      barrier(_comm); // differences between ranks before this point do not belong to the search
      searchOnce();
      if (step == 0)
        _first_seconds = allReduce(_comm, _recorder.seconds(whole), MPI_MAX);
      if (step >= _config.search.warmup)
        _recorder.endStep();
    }
  }

  void searchOnce() {
    const Region region(whole);
    if (_config.search.local)
      _search.update(_space, _moving.surface());
    else
      _search.updateGhosts(_space, _moving.surface());
  }

  SearchOnlyReport makeReport(const MemoryAbove& memory) const {
    SearchOnlyReport report;
    report.case_name = _options.caseName();
    report.title = _config.title;
    report.provenance = describeRun(_comm);
    report.nodes = _num_nodes;
    report.faces = _num_faces;
    report.method = nameOf(_config.search.method);
    report.timing = _options.timing;
    report.with_local_search = _config.search.local;
    report.shuffled = _config.search.shuffle;
    report.jitter = _config.search.jitter;
    report.drift = _config.search.drift;
    report.seed = _config.search.seed;
    report.warmup = _config.search.warmup;
    report.repetitions = _config.search.repetitions;
    report.margin = margin();
    report.searches = _search.searches() - _searches_before;
    report.first_seconds = _first_seconds;
    report.seconds = {_recorder.secondsPerStep(whole), _recorder.secondsPerStep(global),
                      _recorder.secondsPerStep(local)};
    report.cpu_seconds = {_recorder.busyCpuPerStep(whole), _recorder.busyCpuPerStep(global),
                          _recorder.busyCpuPerStep(local)};
    report.timers = _recorder.searchTimersPerStep();
    report.phases = _recorder.phases();
    addCounts(report);
    report.peak = overRanks(_comm, memory.peakBytes());
    report.inputs = overRanks(_comm, memory.baselineBytes());
    report.search = overRanks(_comm, memory.bytes());
    return report;
  }

  void addCounts(SearchOnlyReport& report) const {
    const contact::SearchStatistics counts = _search.statistics();
    const auto sum = [&](std::int64_t count) { return allReduce(_comm, count, MPI_SUM); };
    report.ghost_faces = sum(counts.num_ghosts);
    report.candidate_pairs = sum(_search.pairs().count);
    report.node_boxes_sent = sum(counts.node_boxes_sent);
    report.faces_tested = sum(counts.candidate_faces);
    report.overlapping_pairs = sum(counts.overlapping_pairs);
    report.over_ranks = {{"faces", static_cast<double>(_moving.surface().num_faces)},
                         {"ghost_faces", static_cast<double>(counts.num_ghosts)},
                         {"candidate_pairs", static_cast<double>(_search.pairs().count)},
                         {"search", _recorder.busySeconds(whole)}};
    reduceOverRanks(_comm, report.over_ranks);
    report.most_partners = allReduce(_comm, std::int64_t(counts.num_partners), MPI_MAX);
  }

  static constexpr const char* whole = "contact::search";
  static constexpr const char* global = "contact::findGhosts";
  static constexpr const char* local = "contact::search::local_search";

  MPI_Comm _comm;
  const Config& _config;
  const Options& _options;
  exec_space _space;
  PhaseRecorder _recorder;
  double _edge = 0; // the shortest, length
  std::int64_t _num_nodes = 0, _num_faces = 0; // all ranks
  SearchSurface _moving;
  contact::CandidateSearch _search;
  std::int64_t _searches_before = 0; // not counted
  double _first_seconds = 0;
};

} // namespace

int runSearch(MPI_Comm comm, const Config& config, const Options& options) {
  if (!config.wall)
    throw InputError(config.deck_path + ": 'brickwall search' needs a [wall]");
  if (config.search.audit > 0 && rankOf(comm) == 0)
    std::cout << "warning: search.audit has no effect on 'brickwall search'" << std::endl;
  return SearchRun(comm, config, options).execute();
}

} // namespace brickwall::miniapp
