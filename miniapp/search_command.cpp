// `brickwall search`: the global and local search alone on the wall's moving surface, repeated.
#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "contact/global_search.hpp"
#include "contact/local_search.hpp"
#include "io/wall_generator.hpp"
#include "miniapp/commands.hpp"
#include "miniapp/phase_report.hpp"
#include "miniapp/report.hpp"
#include "miniapp/scene.hpp"
#include "miniapp/search_choice.hpp"
#include "miniapp/search_surface.hpp"

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

} // namespace

int runSearch(MPI_Comm comm, const Config& config, const Options& options) {
  if (!config.wall)
    throw InputError(config.deck_path + ": 'brickwall search' needs a [wall]");
  const exec_space space;
  const double edge = shortestEdge(*config.wall);
  const auto seed = static_cast<std::uint64_t>(config.search.seed);
  const auto part = io::generateWallSurface(comm, toWallConfig(*config.wall),
                                            io::WallJitter{config.search.jitter, seed});
  SearchSurface moving(space, part, rankOf(comm), config.search.drift * edge, seed);
  const contact::SearchConfig search = searchConfig(config, edge, false);
  contact::GlobalSearch global_search(comm, search);
  contact::LocalSearch local_search(search);

  PhaseRecorder recorder(comm, options.timing);
  recorder.watch("search", config.search.repetitions);
  const std::int64_t steps = config.search.warmup + config.search.repetitions;
  for (std::int64_t step = 0; step < steps; ++step) {
    if (step == config.search.warmup)
      recorder.reset();
    moving.move(space, step);
    space.fence();
    {
      const Region region("search");
      const contact::Surface surface = moving.surface();
      const auto& ghosts = global_search.findGhosts(space, surface);
      local_search.findCandidatePairs(space, surface, ghosts, global_search.boxes());
    }
    if (step >= config.search.warmup)
      recorder.endStep();
  }

  RunReport report;
  report.command = "search";
  report.case_name = options.caseName();
  report.title = config.title;
  report.provenance = describeRun(comm);
  report.nodes = part.num_global_nodes;
  report.faces = part.num_global_faces;
  report.steps = steps;
  report.counted_steps = config.search.repetitions;
  report.search_seconds = allReduce(comm, recorder.seconds("search"), MPI_MAX);
  report.loop_seconds = report.search_seconds;
  report.counted_searches = config.search.repetitions;
  report.phases = recorder.phases();
  report.search_timers = recorder.searchTimers();
  report.search.method = nameOf(config.search.method);
  report.search.searches = steps;
  report.search.seconds_per_step = recorder.medianPerStep("search");
  report.search.ghost_faces = allReduce(comm, std::int64_t(global_search.ghosts().count), MPI_SUM);
  report.search.candidate_pairs = allReduce(comm, local_search.pairs().count, MPI_SUM);
  report.max_rank_bytes = peakRankBytes(comm);
  if (options.write_output) {
    makeDirectory(comm, options.output_directory);
    writeReport(comm, options.output_directory + "/report.json", report);
  }
  if (rankOf(comm) == 0)
    printReport(std::cout, report);
  return 0;
}

} // namespace brickwall::miniapp
