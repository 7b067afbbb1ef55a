// What the reports of `run` and `search` have in common: their JSON and their tables. Only report.cpp and
// search_report.cpp include this.
#pragma once

#include "miniapp/output/report.hpp"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <iosfwd>
#include <string>
#include <vector>

namespace brickwall::miniapp {

// "version" to "execution_space".
void addProvenance(nlohmann::ordered_json& json, const Provenance& provenance);

nlohmann::ordered_json toJson(const std::vector<PhaseTime>& phases);

// The text of a JSON file. Bytes that are no UTF-8 (of a title, a host name) are replaced, not thrown at.
std::string jsonText(const nlohmann::ordered_json& json);

inline double ratio(double amount, double seconds) {
  return seconds > 0 ? amount / seconds : 0;
}

template <class... Values>
std::string format(const char* how, Values... values) {
  char line[256];
  std::snprintf(line, sizeof(line), how, values...);
  return line;
}

void printTable(std::ostream& out, const char* title, const std::vector<PhaseTime>& phases);

// The lines "CASE: ... " and ranks, threads, Kokkos and memory that open each report; `counts` is what follows the colon.
void printHeading(std::ostream& out, const std::string& case_name, const std::string& counts,
                  const Provenance& provenance, std::int64_t max_rank_bytes);

} // namespace brickwall::miniapp
