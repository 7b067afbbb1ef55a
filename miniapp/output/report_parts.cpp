#include "miniapp/output/report_parts.hpp"

#include <ostream>

namespace brickwall::miniapp {

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
}

nlohmann::ordered_json toJson(const std::vector<PhaseTime>& phases) {
  auto list = nlohmann::ordered_json::array();
  for (const PhaseTime& phase : phases)
    list.push_back({{"name", phase.name},
                    {"calls", phase.calls},
                    {"min", phase.min},
                    {"mean", phase.mean},
                    {"max", phase.max}});
  return list;
}

std::string jsonText(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void printTable(std::ostream& out, const char* title, const std::vector<PhaseTime>& phases) {
  out << format("%-44s %10s %11s %11s %11s\n", title, "calls", "min s", "mean s", "max s");
  for (const PhaseTime& phase : phases)
    out << format("  %-42s %10lld %11.5f %11.5f %11.5f\n", phase.name.c_str(),
                  static_cast<long long>(phase.calls), phase.min, phase.mean, phase.max);
}

void printHeading(std::ostream& out, const std::string& case_name, const std::string& counts,
                  const Provenance& provenance, std::int64_t max_rank_bytes) {
  out << "\n" << case_name << ": " << counts << "\n";
  out << format("%d ranks x %d threads, %s, Kokkos %s, largest rank %.1f MB\n\n", provenance.ranks,
                provenance.threads_per_rank, provenance.execution_space.c_str(),
                provenance.kokkos.c_str(), static_cast<double>(max_rank_bytes) / 1e6);
}

} // namespace brickwall::miniapp
