#include "miniapp/output/run_report.hpp"

#include "contact/base/mpi.hpp"
#include "miniapp/deck/words.hpp"
#include "miniapp/output/skipped_work.hpp"
#include "miniapp/timing/process_memory.hpp"

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

std::vector<RankValue> loadOfRank(const Simulation& simulation, const PhaseRecorder& recorder) {
  std::vector<RankValue> load = countsOfRank(simulation);
  const double search = recorder.busySeconds("contact::search"),
               enforcement = recorder.busySeconds("miniapp::enforceContact"),
               distribution = recorder.busySeconds("miniapp::balanceContact");
  load.push_back({"search", search});
  load.push_back({"enforcement", enforcement});
  load.push_back({"distribution", distribution});
  load.push_back(
      {"solver", recorder.busySeconds("miniapp::step") - search - enforcement - distribution});
  load.push_back({"contact_with_waits", recorder.seconds("contact::search") +
                                            recorder.seconds("miniapp::enforceContact") +
                                            recorder.seconds("miniapp::balanceContact")});
  return load;
}

void judgeNumbers(RunReport& report) {
  if (report.has_load && report.steps > 0 && report.balance.peak_total == 0)
    report.warnings.push_back(
        "the loads have moved nothing: their forces on nodes are below the rounding of forces, or "
        "act on nodes with prescribed motion only");
  if (report.balance.peak_total > 0 && !report.balance.is_above_noise)
    report.warnings.push_back(
        format("the energy of the run, at most %.3g, is within the rounding of forces and "
               "sums: its relative errors have no meaning",
               report.balance.peak_total));
  if (report.contact.lost > 0)
    report.warnings.push_back(
        "contacts under load that were lost because they were deeper than the search reaches, or "
        "far beyond a bent edge of their face: " +
        std::to_string(report.contact.lost) + "; a larger contact.tolerance keeps them");
  if (report.contact.missed_pairs > 0)
    report.failures.push_back("the audit of the search found " +
                              counted(report.contact.missed_pairs, "candidate pair") +
                              " that the lists in use missed");
}

std::int64_t peakRankBytes(MPI_Comm comm) {
  return allReduce(comm, peakResidentBytes(), MPI_MAX);
}

RunReport runReport(MPI_Comm comm, const Config& config, const Scene& scene,
                    const Simulation& simulation, const PhaseRecorder& recorder) {
  RunReport report;
  report.title = config.title;
  report.units = nameOf(config.units);
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
  for (const PressureConfig& load : config.pressures)
    report.has_load = report.has_load || (load.peak != 0 && load.pulse.start < report.end_time);
  report.contact = contactCounts(simulation);
  report.over_ranks = loadOfRank(simulation, recorder);
  reduceOverRanks(comm, report.over_ranks);
  report.search = {nameOf(config.search.method), nameOf(config.search.decomposition),
                   config.search.margin,         config.contact.enabled ? config.search.audit : 0,
                   dropsSameBody(config),        recorder.medianPerStep("contact::search")};
  report.rebalance = nameOf(config.partition.rebalance);
  report.time_step = stepReport(config, simulation);
  report.balance = simulation.balance();
  report.skipped = skippedWork(config, simulation, report.contact, report.elements);
  report.checksums = checksums(simulation);
  report.max_rank_bytes = peakRankBytes(comm);
  judgeNumbers(report);
  return report;
}

void addMessages(MPI_Comm comm, const MessageCounts& before, RunReport& report) {
  if (report.counted_steps == 0)
    return;
  const auto steps = static_cast<double>(report.counted_steps);
  const MessageCounts& now = messagesSent();
  std::vector<RankValue> sent = {
      {"messages", static_cast<double>(now.messages - before.messages) / steps},
      {"bytes_sent", 8 * static_cast<double>(now.words - before.words) / steps}};
  reduceOverRanks(comm, sent);
  report.over_ranks.insert(report.over_ranks.end(), sent.begin(), sent.end());
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
