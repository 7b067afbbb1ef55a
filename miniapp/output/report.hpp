// The report of a run: report.json (its field names are fixed), the printed tables, the FOM line
// and PASS or FAIL; and the parts that it has in common with the report of `brickwall search`.
#pragma once

#include "miniapp/simulation/diagnostics.hpp"
#include "miniapp/simulation/element_balance.hpp"
#include "miniapp/timing/device.hpp"
#include "miniapp/timing/phase_recorder.hpp"

#include <mpi.h>
#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <cstdio>
#include <iosfwd>
#include <string>
#include <vector>

namespace brickwall::miniapp {

// How the program was built and where it runs.
struct Provenance {
  std::string version, commit, compiler, flags, kokkos; // of the build
  std::string mpi; // the library in use
  std::string host, cpu; // of rank 0
  int ranks = 1;
  int threads_per_rank = 1;
  std::string execution_space;
  Device device; // of rank 0; bytes_in_use are those of the fullest of all ranks
};
// Collective.
Provenance describeRun(MPI_Comm comm);

// The text of --version.
std::string versionText();

// The search that the deck asks for, and the time that it took.
struct SearchReport {
  std::string method; // search.method
  std::string decomposition; // search.decomposition
  double margin = 0; // search.reuse.margin
  std::int64_t audit = 0; // search.audit; 0 without contact
  bool drops_same_body = false; // pairs of a node and a face of its own body are dropped
  double seconds_per_step = 0; // PhaseRecorder::medianPerStep("contact::search")
};

struct StepReport {
  std::string bound; // time.bound
  StepGain gain;
  double first = 0, last = 0; // dt
  std::vector<StepCut> cuts;
  std::int64_t guarded_steps = 0; // steps with nodes so fast that the guard tested their pairs
};

// See skipped_work.hpp.
struct SkippedPart {
  std::string what; // e.g. "elements at rest"
  double share = 0; // 0 to 1
  std::string of; // the whole to which the share refers, in words
  std::string key; // of the deck, which does the work nevertheless; empty: none
};

struct RunReport {
  std::string case_name, title, units;
  std::vector<std::string> options; // of the command line that change the times, as typed
  Provenance provenance;
  std::int64_t elements = 0, nodes = 0, faces = 0; // all ranks
  std::int64_t steps = 0;
  double end_time = 0;
  std::int64_t counted_steps = 0; // steps within loop_seconds (the first is not)
  double loop_seconds = 0; // time loop without output and without the first step, slowest rank
  double setup_seconds = 0; // from the deck to the first step without output, slowest rank
  double solver_seconds = 0; // loop_seconds without contact search and enforcement
  double search_seconds = 0; // the part of loop_seconds in region "contact::search"
  std::int64_t counted_searches = 0; // searches within search_seconds
  std::vector<PhaseTime> phases; // PhaseRecorder::phases
  std::vector<PhaseTime> search_timers; // PhaseRecorder::searchTimers
  SearchReport search;
  std::string rebalance; // partition.rebalance
  std::vector<Rebalancing> rebalancings;
  StepReport time_step;
  std::vector<SkippedPart> skipped;
  Checksums checksums;
  mechanics::EnergyBalance balance;
  bool has_load = false; // a pressure that begins before the end
  bool has_contact = false;
  ContactCounts contact;
  std::vector<RankValue> over_ranks; // counts of the last step and times, over the ranks
  std::int64_t max_rank_bytes = 0; // peakRankBytes() of run_report.hpp
  std::vector<std::string> warnings;
  std::size_t printed_warnings = 0; // the first of them, which were printed during the run
  std::vector<std::string> failures; // reasons of a failed run; empty: PASS
  std::string stopped; // why the run ended early though nothing failed; "": it did not
  std::int64_t first_step = 0; // from which a restarted run continued

  double elementStepsPerSecond() const; // 0 where no time was measured
  double solverElementStepsPerSecond() const;
  double faceSearchesPerSecond() const;
  bool pass() const { return failures.empty() && stopped.empty(); }
};

// The report as JSON text.
std::string reportJson(const RunReport& report);

// Table of phases, FOM line, and last line PASS, FAIL or STOPPED with the reasons. For the standard
// output of rank 0. If `quiet`, only warnings, FOM line and last line.
void printReport(std::ostream& out, const RunReport& report, bool quiet = false);

// Parts of both reports.

// "version" to "device".
void addProvenance(nlohmann::ordered_json& json, const Provenance& provenance);

nlohmann::ordered_json toJson(const std::vector<PhaseTime>& phases);
// "imbalance": the largest rank, the mean of all, and their ratio.
nlohmann::ordered_json toJson(const std::vector<RankValue>& over_ranks);

// The text of a JSON file. Bytes that are not UTF-8 (of a title, a host name) are replaced.
std::string jsonText(const nlohmann::ordered_json& json);

// Without phases that were not called.
void printTable(std::ostream& out, const char* title, const std::vector<PhaseTime>& phases);

// The lines "CASE: counts" and ranks, threads, Kokkos and memory that open each report, and that of
// a device.
void printHeading(std::ostream& out, const std::string& case_name, const std::string& counts,
                  const Provenance& provenance, std::int64_t max_rank_bytes);

inline double ratio(double amount, double seconds) {
  return seconds > 0 ? amount / seconds : 0;
}

// A std::int64_t as %lld takes it.
inline long long printable(std::int64_t number) {
  return number;
}
template <class Value>
Value printable(Value value) {
  return value;
}
template <class... Values>
std::string format(const char* how, Values... values) {
  const int length = std::snprintf(nullptr, 0, how, printable(values)...);
  std::string text(static_cast<std::size_t>(length), '\0');
  std::snprintf(text.data(), text.size() + 1, how, printable(values)...);
  return text;
}

// "1 face", "2 faces"; `several` where the plural has no s.
template <class Count>
std::string counted(Count count, const std::string& one, const std::string& several = "") {
  const std::string plural = several.empty() ? one + "s" : several;
  return std::to_string(count) + " " + (count == 1 ? one : plural);
}

} // namespace brickwall::miniapp
