#include "miniapp/output/search_report.hpp"

#include "contact/base/mpi.hpp"

#include <nlohmann/json.hpp>

#include <ostream>

namespace brickwall::miniapp {
namespace {

nlohmann::ordered_json toJson(const StepStatistics& steps) {
  return {{"min", steps.min},
          {"median", steps.median},
          {"max", steps.max},
          {"mean", steps.mean},
          {"imbalance", steps.imbalance}};
}

nlohmann::ordered_json toJson(const SearchTimes& times) {
  return {{"search", toJson(times.whole)},
          {"global_search", toJson(times.global)},
          {"local_search", toJson(times.local)}};
}

nlohmann::ordered_json toJson(const std::vector<PhaseSteps>& timers, bool with_cpu) {
  auto list = nlohmann::ordered_json::array();
  for (const PhaseSteps& timer : timers) {
    auto entry = nlohmann::ordered_json{{"name", timer.name}};
    entry.update(toJson(timer.seconds));
    if (with_cpu)
      entry["cpu_seconds"] = toJson(timer.cpu_seconds);
    list.push_back(entry);
  }
  return list;
}

nlohmann::ordered_json toJson(const RankBytes& bytes) {
  return {{"max_rank_bytes", bytes.max}, {"sum_bytes", bytes.sum}};
}

void printSteps(std::ostream& out, const std::string& name, const StepStatistics& steps) {
  out << format("  %-42s %10.3f %10.3f %10.3f %10.3f %9.3f\n", name.c_str(), 1e3 * steps.min,
                1e3 * steps.median, 1e3 * steps.max, 1e3 * steps.mean, steps.imbalance);
}

void printTimes(std::ostream& out, const std::string& title, const SearchTimes& times) {
  out << format("%-44s %10s %10s %10s %10s %9s\n", title.c_str(), "min ms", "median ms", "max ms",
                "mean ms", "imbalance");
  printSteps(out, "whole search", times.whole);
  printSteps(out, "global search", times.global);
  printSteps(out, "local search", times.local);
}

} // namespace

RankBytes overRanks(MPI_Comm comm, std::int64_t bytes) {
  return {allReduce(comm, bytes, MPI_MAX), allReduce(comm, bytes, MPI_SUM)};
}

double SearchOnlyReport::faceSearchesPerSecond() const {
  if (searches == repetitions)
    return ratio(static_cast<double>(faces), seconds.whole.median);
  // Repetitions that kept their lists took time as well.
  return ratio(static_cast<double>(faces) * static_cast<double>(searches),
               seconds.whole.mean * static_cast<double>(repetitions));
}

std::string searchReportJson(const SearchOnlyReport& r) {
  nlohmann::ordered_json json;
  json["schema"] = "brickwall-search-1";
  json["case"] = r.case_name;
  json["title"] = r.title;
  json["command"] = "search";
  addProvenance(json, r.provenance);
  json["nodes"] = r.nodes;
  json["faces"] = r.faces;
  json["method"] = r.method;
  json["timing"] = nameOf(r.timing);
  json["local_search"] = r.with_local_search;
  json["shuffled"] = r.shuffled;
  json["jitter"] = r.jitter;
  json["drift"] = r.drift;
  json["seed"] = r.seed;
  json["warmup"] = r.warmup;
  json["repetitions"] = r.repetitions;
  json["margin"] = r.margin;
  json["searches"] = r.searches;
  json["fom"] = {{"face_searches_per_second", r.faceSearchesPerSecond()}};
  json["first_search_seconds"] = r.first_seconds;
  json["seconds"] = toJson(r.seconds);
  json["cpu_seconds"] = toJson(r.cpu_seconds);
  json["timers"] = toJson(r.timers, r.timing == Timing::paper);
  json["phases"] = toJson(r.phases);
  json["counts"] = {{"ghost_faces", r.ghost_faces},
                    {"candidate_pairs", r.candidate_pairs},
                    {"node_boxes_sent", r.node_boxes_sent},
                    {"faces_tested", r.faces_tested},
                    {"overlapping_pairs", r.overlapping_pairs},
                    {"most_partners", r.most_partners}};
  json["imbalance"] = toJson(r.over_ranks);
  json["memory"] = {
      {"peak", toJson(r.peak)}, {"inputs", toJson(r.inputs)}, {"search", toJson(r.search)}};
  json["pass"] = true;
  return jsonText(json);
}

void printSearchReport(std::ostream& out, const SearchOnlyReport& r) {
  printHeading(out, r.case_name,
               counted(r.nodes, "node") + ", " + counted(r.faces, "face") +
                   (r.shuffled ? ", shuffled" : "") + "; method " + r.method,
               r.provenance, r.peak.max);
  if (r.margin > 0)
    out << format(
        "margin of %g edges: %lld of %lld repetitions searched, the others kept their lists\n",
        r.margin, r.searches, r.repetitions);
  printTimes(out, format("wall clock of a search (%lld counted)", r.repetitions), r.seconds);
  printTimes(out,
             r.timing == Timing::paper ? "CPU time of a rank, without waiting"
                                       : "CPU time of a rank, waiting included",
             r.cpu_seconds);
  out << "timers of the global search (own time)\n";
  for (const PhaseSteps& timer : r.timers)
    printSteps(out, timer.name, timer.seconds);
  out << format("first search %.3f ms; last search: ", 1e3 * r.first_seconds)
      << counted(r.ghost_faces, "ghost face") << ", "
      << counted(r.candidate_pairs, "candidate pair") << "\n";
  out << "sent " << counted(r.node_boxes_sent, "node box", "node boxes") << ", tested "
      << counted(r.faces_tested, "face") << ", " << counted(r.overlapping_pairs, "overlapping pair")
      << " in search 2\n";
  out << format(
      "memory: %.1f MB before the searches, %.1f MB more for the searches (largest rank: %.1f)\n",
      1e-6 * static_cast<double>(r.inputs.sum), 1e-6 * static_cast<double>(r.search.sum),
      1e-6 * static_cast<double>(r.search.max));
  if (r.searches > 0)
    out << format("FOM face_searches_per_second=%.6g seconds_per_search=%.6g\n",
                  r.faceSearchesPerSecond(), r.seconds.whole.median);
  else
    out << "no FOM: none of the counted repetitions searched, all kept their lists\n";
  out << "PASS" << std::endl;
}

} // namespace brickwall::miniapp
