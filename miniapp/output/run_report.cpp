#include "miniapp/output/run_report.hpp"

#include "contact/base/mpi.hpp"
#include "miniapp/deck/words.hpp"
#include "miniapp/output/skipped_work.hpp"

#ifdef BRICKWALL_ADIAK
#include <adiak.hpp>
#include <nlohmann/json.hpp>
#endif

namespace brickwall::miniapp {

namespace {

StepReport stepReport(const Config& config, const Simulation& simulation) {
  StepReport steps;
  steps.bound = nameOf(config.time.bound);
  steps.gain = simulation.steps().gain();
  steps.cuts = simulation.steps().cuts();
  steps.last = simulation.clock().dt;
  steps.first = steps.cuts.empty() ? steps.last : steps.cuts.front().from;
  steps.guarded_steps = simulation.guardedSteps();
  return steps;
}

} // namespace

RunReport runReport(MPI_Comm comm, const Config& config, const Scene& scene,
                    const Simulation& simulation, const PhaseRecorder& recorder) {
  RunReport report;
  report.title = config.title;
  report.provenance = describeRun(comm);
  report.elements = scene.part.num_global_elems;
  report.nodes = scene.part.num_global_nodes;
  report.faces = scene.num_faces;
  report.steps = simulation.clock().step;
  report.end_time = simulation.clock().time;
  report.counted_steps = maxOf<std::int64_t>(report.steps - 1, 0);
  const auto slowest = [&](double seconds) { return allReduce(comm, seconds, MPI_MAX); };
  report.loop_seconds = slowest(recorder.seconds("miniapp::step"));
  report.search_seconds = slowest(recorder.seconds("contact::search"));
  report.solver_seconds =
      slowest(recorder.seconds("miniapp::step") - recorder.seconds("contact::search") -
              recorder.seconds("miniapp::enforceContact"));
  report.phases = recorder.phases();
  report.search_timers = recorder.searchTimers();
  report.has_contact = config.contact.enabled;
  report.contact = contactCounts(simulation);
  report.counts_over_ranks = countsOverRanks(simulation);
  report.search = {nameOf(config.search.method), nameOf(config.search.decomposition),
                   config.search.margin,         config.contact.enabled ? config.search.audit : 0,
                   dropsSameBody(config),        recorder.medianPerStep("contact::search")};
  report.time_step = stepReport(config, simulation);
  report.balance = simulation.balance();
  report.skipped = skippedWork(config, simulation, report.contact, report.elements);
  report.checksums = checksums(simulation);
  report.max_rank_bytes = peakRankBytes(comm);
  judgeNumbers(report);
  return report;
}

void giveToAdiak([[maybe_unused]] MPI_Comm comm, [[maybe_unused]] const RunReport& report) {
#ifdef BRICKWALL_ADIAK
  adiak::init(&comm);
  adiak::collect_all();
  const auto json = nlohmann::json::parse(reportJson(report));
  for (const auto& fields : {json, json["fom"]})
    for (const auto& [name, value] : fields.items())
      if (value.is_string())
        adiak::value(name, value.get<std::string>());
      else if (value.is_number_integer())
        adiak::value(name, value.get<long>());
      else if (value.is_number())
        adiak::value(name, value.get<double>());
  adiak::fini();
#endif
}

} // namespace brickwall::miniapp
