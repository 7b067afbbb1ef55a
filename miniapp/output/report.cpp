// The names in report.json are fixed: scripts and comparisons of runs read them.
#include "miniapp/output/report.hpp"

#include "contact/base/backend.hpp"
#include "contact/base/mpi.hpp"
#include "miniapp/output/build_info.hpp"
#include "miniapp/output/git_commit.hpp"
#include "miniapp/timing/region_tree.hpp"

#include <nlohmann/json.hpp>

#include <fstream>
#include <map>
#include <ostream>
#include <unistd.h>

namespace brickwall::miniapp {
namespace {

// Reports keep these names of phases, whatever the regions are called.
std::string phaseName(const std::string& region) {
  static const std::map<std::string, std::string> names = [] {
    std::map<std::string, std::string> names = {
        {"contact::search", "search"},
        {"contact::search::local_search", "search::local search"},
        {"miniapp::step", "step"},
        {"miniapp::output", "output"},
        {"miniapp::moveNodes", "step::drift"},
        {"miniapp::guardAgainstTunnelling", "step::tunnelling guard"},
        {"miniapp::auditCandidates", "step::audit of pairs"},
        {"miniapp::shortenIfUnstable", "step::stable step"},
        {"miniapp::computeInternalForces", "step::internal force"},
        {"miniapp::addLoads", "step::loads"},
        {"miniapp::sumSharedNodes", "step::shared-node sum"},
        {"miniapp::enforceContact", "step::contact enforcement"},
        {"miniapp::kickVelocities", "step::kick"},
        {"miniapp::stepFreeBricks", "step::free bricks"},
        {"miniapp::bookEnergies", "step::ledger"}};
    for (const std::string& timer : searchTimerNames())
      names[searchTimerRegion(timer)] = "search::" + timer;
    return names;
  }();
  const auto name = names.find(region);
  return name == names.end() ? region : name->second;
}

std::string hostName() {
  char name[256] = "";
  gethostname(name, sizeof(name) - 1);
  return name;
}

std::string cpuName() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.compare(0, 10, "model name") == 0 && line.find(": ") != std::string::npos)
      return line.substr(line.find(": ") + 2);
  return "unknown";
}

std::string kokkosVersion() {
  return std::to_string(KOKKOS_VERSION / 10000) + "." + std::to_string(KOKKOS_VERSION / 100 % 100) +
         "." + std::to_string(KOKKOS_VERSION % 100);
}

// The first line: "Open MPI v4.1.4, package: ..." up to the comma.
std::string mpiVersion() {
  char text[MPI_MAX_LIBRARY_VERSION_STRING] = "";
  int length = 0;
  checkMpi(MPI_Get_library_version(text, &length), "MPI_Get_library_version");
  const std::string version(text, static_cast<std::size_t>(length));
  return version.substr(0, version.find_first_of(",\n"));
}

const char* wordOf(StepCut::Reason reason) {
  return reason == StepCut::Reason::tunnelling ? "tunnelling" : "stability";
}

nlohmann::ordered_json toJson(const StepReport& steps) {
  auto cuts = nlohmann::ordered_json::array();
  for (const StepCut& cut : steps.cuts)
    cuts.push_back({{"reason", wordOf(cut.reason)},
                    {"step", cut.step},
                    {"time", cut.time},
                    {"from", cut.from},
                    {"to", cut.to}});
  return {{"first", steps.first},
          {"last", steps.last},
          {"bound", steps.bound},
          {"gain", steps.gain.step},
          {"products", steps.gain.products},
          {"body_types", steps.gain.body_types},
          {"guarded_steps", steps.guarded_steps},
          {"cuts", cuts}};
}

nlohmann::ordered_json balanceJson(const RunReport& r) {
  const mechanics::EnergyBalance& balance = r.balance;
  nlohmann::ordered_json json = {{"energy_error", balance.energy_error},
                                 {"momentum_error", balance.momentum_error},
                                 {"angular_momentum_error", balance.angular_momentum_error},
                                 {"ledger_residual", balance.ledger_residual},
                                 {"stored_error", balance.stored_error},
                                 {"hourglass_share", balance.hourglassShare()}};
  if (r.has_contact) {
    json["contact_error"] = balance.contact_error;
    json["penetration"] = r.contact.largest_penetration;
  }
  json["external_work"] = balance.external_work;
  json["dissipated_energy"] = balance.dissipated.total();
  json["peak_kinetic_energy"] = balance.peak_kinetic;
  json["peak_stored_energy"] = balance.peak_stored;
  json["peak_energy"] = balance.peak_total;
  return json;
}

nlohmann::ordered_json partitionJson(const RunReport& r) {
  auto rebalancings = nlohmann::ordered_json::array();
  for (const auto& [step, seconds, before, after] : r.rebalancings)
    rebalancings.push_back({{"step", step},
                            {"seconds", seconds},
                            {"imbalance_before", before},
                            {"imbalance_after", after}});
  return {{"rebalance", r.rebalance}, {"rebalancings", rebalancings}};
}

void printRebalancings(std::ostream& out, const RunReport& r) {
  if (!r.rebalancings.empty())
    out << "elements rebalanced: " << counted(r.rebalancings.size(), "time")
        << format("; the first time in %.3g s, imbalance of work %.3g, then %.3g\n",
                  r.rebalancings[0].seconds, r.rebalancings[0].imbalance_before,
                  r.rebalancings[0].imbalance_after);
}

double stepsPerSearch(const ContactCounts& counts) {
  return ratio(static_cast<double>(counts.updates), static_cast<double>(counts.searches));
}

void printSteps(std::ostream& out, const StepReport& steps) {
  out << format("time step: %.4g at the start, %.4g at the end, cut ", steps.first, steps.last)
      << counted(steps.cuts.size(), "time");
  constexpr std::size_t most = 4;
  for (std::size_t i = 0; i < minOf(most, steps.cuts.size()); ++i) {
    const StepCut& cut = steps.cuts[i];
    out << format("%s to %.4g in step %lld for %s", i == 0 ? ":" : ",", cut.to, cut.step,
                  wordOf(cut.reason));
  }
  out << (steps.cuts.size() > most ? ", and so on" : "");
  if (steps.bound == "lanczos")
    out << format("; %.1f %% longer than by elements (Lanczos, %d products, body types: %lld)",
                  100 * (steps.gain.step - 1), steps.gain.products, steps.gain.body_types);
  out << "; tunnelling guard active in " << counted(steps.guarded_steps, "step") << "\n";
}

void printBalance(std::ostream& out, const RunReport& r) {
  const mechanics::EnergyBalance& balance = r.balance;
  out << format("balance: energy error %.3e, momentum error %.3e, external work %.6e, peak "
                "kinetic %.6e, peak stored %.6e\n",
                balance.energy_error, balance.momentum_error, balance.external_work,
                balance.peak_kinetic, balance.peak_stored);
  out << format("gauges: ledger residual %.1e, angular momentum error %.1e, stored error %.1e, "
                "hourglass share %.2g",
                balance.ledger_residual, balance.angular_momentum_error, balance.stored_error,
                balance.hourglassShare());
  if (r.has_contact)
    out << format(", contact error %.1e, penetration %.2g", balance.contact_error,
                  r.contact.largest_penetration);
  out << "\n";
}

} // namespace

Provenance describeRun(MPI_Comm comm) {
  Provenance run;
  run.version = build_info::version;
  run.commit = BRICKWALL_COMMIT;
  run.compiler = build_info::compiler;
  run.flags = build_info::flags;
  run.kokkos = kokkosVersion();
  run.mpi = mpiVersion();
  run.host = broadcast(comm, hostName());
  run.cpu = broadcast(comm, cpuName());
  run.ranks = sizeOf(comm);
  run.threads_per_rank = host_exec_space().concurrency();
  run.execution_space = exec_space::name();
  run.device = describeDevice();
  run.device.name = broadcast(comm, run.device.name);
  run.device.bytes_in_use = allReduce(comm, run.device.bytes_in_use, MPI_MAX);
  return run;
}

std::string versionText() {
  return std::string("brickwall ") + build_info::version + " (commit " + BRICKWALL_COMMIT + ")\n" +
         "compiler " + build_info::compiler + "\nflags    " + build_info::flags + "\nKokkos   " +
         kokkosVersion() + ", " + exec_space::name() + "\n";
}

void addProvenance(nlohmann::ordered_json& json, const Provenance& provenance) {
  json["version"] = provenance.version;
  json["commit"] = provenance.commit;
  json["compiler"] = provenance.compiler;
  json["flags"] = provenance.flags;
  json["kokkos"] = provenance.kokkos;
  json["mpi"] = provenance.mpi;
  json["host"] = provenance.host;
  json["cpu"] = provenance.cpu;
  json["ranks"] = provenance.ranks;
  json["threads_per_rank"] = provenance.threads_per_rank;
  json["execution_space"] = provenance.execution_space;
  const Device& device = provenance.device;
  json["device"] = device.name;
  if (device.bytes > 0) {
    json["device_versions"] = device.versions;
    json["device_memory"] = {{"bytes", device.bytes}, {"bytes_in_use", device.bytes_in_use}};
  }
}

nlohmann::ordered_json toJson(const std::vector<PhaseTime>& phases) {
  auto list = nlohmann::ordered_json::array();
  for (const PhaseTime& phase : phases)
    list.push_back({{"name", phaseName(phase.name)},
                    {"calls", phase.calls},
                    {"min", phase.min},
                    {"mean", phase.mean},
                    {"max", phase.max}});
  return list;
}

nlohmann::ordered_json toJson(const std::vector<RankValue>& over_ranks) {
  auto json = nlohmann::ordered_json::object();
  for (const RankValue& value : over_ranks)
    json[value.what] = {
        {"max", value.max}, {"mean", value.mean}, {"max_over_mean", value.maxOverMean()}};
  return json;
}

std::string jsonText(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void printTable(std::ostream& out, const char* title, const std::vector<PhaseTime>& phases) {
  out << format("%-44s %10s %11s %11s %11s\n", title, "calls", "min s", "mean s", "max s");
  for (const PhaseTime& phase : phases)
    if (phase.calls > 0)
      out << format("  %-42s %10lld %11.5f %11.5f %11.5f\n", phaseName(phase.name).c_str(),
                    phase.calls, phase.min, phase.mean, phase.max);
}

void printHeading(std::ostream& out, const std::string& case_name, const std::string& counts,
                  const Provenance& provenance, std::int64_t max_rank_bytes) {
  out << "\n" << case_name << ": " << counts << "\n";
  out << counted(provenance.ranks, "rank") << " x "
      << counted(provenance.threads_per_rank, "thread")
      << format(", %s, Kokkos %s, largest rank %.1f MB\n", provenance.execution_space.c_str(),
                provenance.kokkos.c_str(), static_cast<double>(max_rank_bytes) / 1e6);
  if (const Device& device = provenance.device; device.bytes > 0)
    out << format("%s, %s, %.1f of %.1f MB in use\n", device.name.c_str(), device.versions.c_str(),
                  static_cast<double>(device.bytes_in_use) / 1e6,
                  static_cast<double>(device.bytes) / 1e6);
  out << '\n';
}

double RunReport::elementStepsPerSecond() const {
  return ratio(static_cast<double>(elements) * static_cast<double>(counted_steps), loop_seconds);
}
double RunReport::solverElementStepsPerSecond() const {
  return ratio(static_cast<double>(elements) * static_cast<double>(counted_steps), solver_seconds);
}
double RunReport::faceSearchesPerSecond() const {
  return ratio(static_cast<double>(faces) * static_cast<double>(counted_searches), search_seconds);
}

std::string reportJson(const RunReport& r) {
  nlohmann::ordered_json json = {{"schema", "brickwall-report-1"},
                                 {"case", r.case_name},
                                 {"title", r.title},
                                 {"units", r.units},
                                 {"command", "run"},
                                 {"options", r.options}};
  addProvenance(json, r.provenance);
  json["elements"] = r.elements;
  json["nodes"] = r.nodes;
  json["faces"] = r.faces;
  json["steps"] = r.steps;
  json["end_time"] = r.end_time;
  json["setup_seconds"] = r.setup_seconds;
  json["loop_seconds"] = r.loop_seconds;
  json["fom"] = {{"element_steps_per_second", r.elementStepsPerSecond()},
                 {"solver_element_steps_per_second", r.solverElementStepsPerSecond()},
                 {"face_searches_per_second", r.faceSearchesPerSecond()}};
  json["phases"] = toJson(r.phases);
  json["search"] = {{"method", r.search.method},
                    {"margin", r.search.margin},
                    {"searches", r.contact.searches},
                    {"steps_per_search", stepsPerSearch(r.contact)},
                    {"rank_box_exchanges", r.contact.rank_box_exchanges},
                    {"decomposition", r.search.decomposition},
                    {"distributions", r.contact.distributions},
                    {"seconds_per_step", r.search.seconds_per_step},
                    {"ghost_faces", r.contact.ghost_faces},
                    {"candidate_pairs", r.contact.candidate_pairs},
                    {"active_contacts", r.contact.active},
                    {"drops_same_body", r.search.drops_same_body}};
  if (r.search.audit > 0) {
    json["search"]["audit"] = r.search.audit;
    json["search"]["missed_pairs"] = r.contact.missed_pairs;
  }
  json["imbalance"] = toJson(r.over_ranks);
  json["partition"] = partitionJson(r);
  json["search_timers"] = toJson(r.search_timers);
  json["time_step"] = toJson(r.time_step);
  json["balance"] = balanceJson(r);
  json["skipped"] = nlohmann::ordered_json::array();
  for (const SkippedPart& part : r.skipped)
    json["skipped"].push_back(
        {{"what", part.what}, {"share", part.share}, {"of", part.of}, {"key", part.key}});
  json["spared"] = json["skipped"]; // the former name, for one release
  // As text: numbers of JSON need not have 64 bits.
  const auto hex = [](std::uint64_t sum) {
    return format("%016llx", static_cast<unsigned long long>(sum));
  };
  json["checksums"] = {{"nodes", hex(r.checksums.nodes)},
                       {"contacts", hex(r.checksums.contacts)},
                       {"interactions", r.checksums.interactions}};
  json["memory"] = {{"max_rank_bytes", r.max_rank_bytes}};
  json["pass"] = r.pass();
  json["stopped"] = r.stopped;
  json["first_step"] = r.first_step;
  json["warnings"] = r.warnings;
  json["failures"] = r.failures;
  return jsonText(json);
}

namespace {

void printTables(std::ostream& out, const RunReport& r) {
  printHeading(out, r.case_name,
               counted(r.elements, "element") + ", " + counted(r.nodes, "node") + ", " +
                   counted(r.faces, "face") + ", " + counted(r.steps, "step") +
                   format(" to time %.6g", r.end_time),
               r.provenance, r.max_rank_bytes);
  printTable(out, "phase, in steps after the first", r.phases);
  out << "\n";
  printTable(out, "global search (own time)", r.search_timers);
  out << "\nsearch: " << r.search.method << ", pairs within one body "
      << (r.search.drops_same_body ? "dropped" : "kept") << ", "
      << counted(r.contact.searches, "search", "searches")
      << (r.contact.searches >= r.contact.updates
              ? ", in every step"
              : format(", one in %.3g steps", stepsPerSearch(r.contact)))
      << format(", median %.3e s per step; last step: ", r.search.seconds_per_step)
      << counted(r.contact.ghost_faces, "ghost face") << ", "
      << counted(r.contact.candidate_pairs, "candidate pair") << ", "
      << counted(r.contact.active, "active contact") << "\n";
  if (r.contact.distributions > 0)
    out << "faces distributed anew: " << counted(r.contact.distributions, "time")
        << " (search.decomposition = " << r.search.decomposition << ")\n";
  printRebalancings(out, r);
  if (r.provenance.ranks > 1) {
    out << "imbalance (largest over mean of the ranks):";
    for (const RankValue& value : r.over_ranks)
      out << format("%s %s %.3g", &value == &r.over_ranks.front() ? "" : ",", value.what,
                    value.maxOverMean());
    out << "\n";
  }
  if (r.search.audit > 0)
    out << "audit: " << counted(r.contact.missed_pairs, "pair") << " missed, all pairs tested "
        << (r.search.audit == 1 ? "in every step" : format("every %lld steps", r.search.audit))
        << "\n";
  printSteps(out, r.time_step);
  printBalance(out, r);
  for (const SkippedPart& part : r.skipped)
    if (part.share > 0)
      out << format("skipped: %s: %.3g %% %s\n", part.what.c_str(), 100 * part.share,
                    part.of.c_str());
}

} // namespace

void printReport(std::ostream& out, const RunReport& r, bool quiet) {
  if (!quiet)
    printTables(out, r);
  for (std::size_t i = r.printed_warnings; i < r.warnings.size(); ++i)
    out << "warning: " << r.warnings[i] << '\n';
  out << format("FOM element_steps_per_second=%.6g face_searches_per_second=%.6g "
                "loop_seconds=%.6g\n",
                r.elementStepsPerSecond(), r.faceSearchesPerSecond(), r.loop_seconds);
  std::string why;
  for (const std::string& failure : r.failures)
    why += (why.empty() ? "" : "; ") + failure;
  out << (r.pass()             ? "PASS"
          : r.failures.empty() ? "STOPPED: " + r.stopped
                               : "FAIL: " + why)
      << std::endl;
}

} // namespace brickwall::miniapp
