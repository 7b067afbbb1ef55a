#include "miniapp/output/run_report.hpp"

#include "contact/base/mpi.hpp"
#include "miniapp/deck/words.hpp"
#include "miniapp/output/skipped_work.hpp"

namespace brickwall::miniapp {

namespace {

SearchReport searchReport(const Config& config, const ContactCounts& counts) {
  SearchReport search;
  search.method = nameOf(config.search.method);
  search.margin = config.search.margin;
  search.searches = counts.searches;
  search.steps_per_search = counts.searches == 0 ? 0
                                                 : static_cast<double>(counts.updates) /
                                                       static_cast<double>(counts.searches);
  search.ghost_faces = counts.ghost_faces;
  search.candidate_pairs = counts.candidate_pairs;
  search.active_contacts = counts.active;
  search.lost_contacts = counts.lost;
  search.audit = config.contact.enabled ? config.search.audit : 0;
  search.missed_pairs = counts.missed_pairs;
  search.drops_same_body = dropsSameBody(config);
  return search;
}

StepReport stepReport(const Config& config, const Simulation& simulation) {
  StepReport steps;
  steps.bound = nameOf(config.time.bound);
  steps.gain = simulation.steps().gain().step;
  steps.products = simulation.steps().gain().products;
  steps.body_types = simulation.steps().gain().body_types;
  const auto& cuts = simulation.steps().cuts();
  steps.last = simulation.clock().dt;
  steps.first = cuts.empty() ? steps.last : cuts.front().from;
  steps.guarded_steps = simulation.guardedSteps();
  for (const StepCut& cut : cuts)
    steps.cuts.push_back({cut.reason == StepCut::Reason::tunnelling ? "tunnelling" : "stability",
                          cut.step, cut.time, cut.from, cut.to});
  return steps;
}

BalanceReport balanceReport(const Config& config, const mechanics::EnergyBalance& balance,
                            const ContactCounts& counts) {
  BalanceReport report;
  report.energy_error = balance.energy_error;
  report.momentum_error = balance.momentum_error;
  report.angular_momentum_error = balance.angular_momentum_error;
  report.ledger_residual = balance.ledger_residual;
  report.stored_error = balance.stored_error;
  report.hourglass_share = balance.hourglassShare();
  report.has_contact = config.contact.enabled;
  report.contact_error = balance.contact_error;
  report.penetration = counts.largest_penetration;
  report.external_work = balance.external_work;
  report.dissipated_energy = balance.dissipated.total();
  report.peak_kinetic_energy = balance.peak_kinetic;
  report.peak_stored_energy = balance.peak_stored;
  report.peak_energy = balance.peak_total;
  report.is_rounding = balance.peak_total > 0 && !balance.is_above_noise;
  return report;
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
  const ContactCounts counts = contactCounts(simulation);
  report.search = searchReport(config, counts);
  report.search.seconds_per_step = recorder.medianPerStep("contact::search");
  report.time_step = stepReport(config, simulation);
  report.balance = balanceReport(config, simulation.balance(), counts);
  report.skipped = skippedWork(config, simulation, counts, report.elements);
  const Checksums sums = checksums(simulation);
  report.checksums = {sums.nodes, sums.contacts, sums.interactions};
  report.max_rank_bytes = peakRankBytes(comm);
  judgeNumbers(report);
  return report;
}

} // namespace brickwall::miniapp
