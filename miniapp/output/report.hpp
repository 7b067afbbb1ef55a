// What a run reports: report.json (field names are fixed), the printed table, the FOM line and PASS
// or FAIL.
#pragma once

#include "miniapp/timing/phase_report.hpp"

#include <mpi.h>

#include <cstdint>
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
};
// Collective.
Provenance describeRun(MPI_Comm comm);

// The text of --version.
std::string versionText();

struct SearchReport {
  std::string method; // "paper", "reference", with "_" and more as the app likes
  double margin = 0; // search.reuse.margin
  std::int64_t searches = 0;
  double steps_per_search = 0; // updates of the lists, the start's included, over searches
  double seconds_per_step = 0; // PhaseRecorder::medianPerStep("search")
  // Of the last step, all ranks.
  std::int64_t ghost_faces = 0, candidate_pairs = 0, active_contacts = 0;
  std::int64_t lost_contacts = 0; // since the start
  std::int64_t audit = 0; // search.audit
  std::int64_t missed_pairs = 0; // in the audited steps
  bool drops_same_body = false; // pairs of a node and a face of its own body are dropped
};

// mechanics/ledger/energy.hpp says what they are.
struct BalanceReport {
  double energy_error = 0, momentum_error = 0, angular_momentum_error = 0;
  double ledger_residual = 0;
  double stored_error = 0;
  double hourglass_share = 0;
  bool has_contact = false; // else these two are left out
  double contact_error = 0, penetration = 0; // of the square root of a face's area
  double external_work = 0, dissipated_energy = 0;
  double peak_kinetic_energy = 0, peak_stored_energy = 0, peak_energy = 0;
  bool is_rounding = false; // something moves, by so little that errors of energy tell nothing
};

// A step that was shortened, with all that follow it.
struct StepCutReport {
  std::string reason; // "stability" or "tunnelling"
  std::int64_t step = 0; // the first of the new length
  double time = 0; // at its begin
  double from = 0, to = 0; // dt
};
struct StepReport {
  std::string bound; // time.bound
  double gain = 1; // stable step over that of the worst element, at rest
  std::int64_t products = 0, body_types = 0; // of Lanczos; 0 with bound = "element"
  double first = 0, last = 0; // dt
  std::vector<StepCutReport> cuts;
  std::int64_t guarded_steps = 0; // steps whose pairs were looked at because some nodes moved fast
};

// miniapp/output/skipped.hpp.
struct SparedReport {
  std::string what; // e.g. "elements at rest"
  double share = 0; // of what it is a part of, 0 to 1
  std::string of; // in words: of what, and what that saves
  std::string key; // of the deck; empty: there is no way to have it
};

// Simulation::checksums.
struct ChecksumReport {
  std::uint64_t nodes = 0, contacts = 0;
  std::int64_t interactions = 0;
};

struct RunReport {
  std::string case_name, title;
  Provenance provenance;
  std::int64_t elements = 0, nodes = 0, faces = 0; // all ranks
  std::int64_t steps = 0;
  double end_time = 0;
  std::int64_t counted_steps = 0; // steps within loop_seconds (the first is not)
  double loop_seconds = 0; // time loop without output and without the first step, slowest rank
  double solver_seconds = 0; // of it, without contact search and enforcement
  double search_seconds = 0; // of it, in region "search"
  std::int64_t counted_searches = 0; // searches within search_seconds
  std::vector<PhaseTime> phases; // PhaseRecorder::phases
  std::vector<PhaseTime> search_timers; // PhaseRecorder::searchTimers
  SearchReport search;
  StepReport time_step;
  std::vector<SparedReport> skipped;
  ChecksumReport checksums;
  BalanceReport balance;
  std::int64_t max_rank_bytes = 0; // see peakRankBytes
  std::vector<std::string> warnings; // what the user should know of a run that passes
  std::size_t warnings_told =
      0; // of these the first ones, which the run has printed when they came up
  std::vector<std::string> failures; // why the run fails; empty: PASS

  double elementStepsPerSecond() const; // 0 where there is nothing to divide by
  double solverElementStepsPerSecond() const;
  double faceSearchesPerSecond() const;
  bool pass() const { return failures.empty(); }
};

// Adds the warnings and failures that follow from the figures alone: contacts that were lost, pairs that were missed.
void judgeFigures(RunReport& report);

// Collective. Peak resident memory of the largest rank so far, bytes.
std::int64_t peakRankBytes(MPI_Comm comm);

// The report as JSON text.
std::string reportJson(const RunReport& report);

// Collective: rank 0 writes; throws OutputError on every rank when that fails.
void writeReport(MPI_Comm comm, const std::string& path, const RunReport& report);
// Collective: rank 0 writes any text to a file, checked to the last byte; for the resolved deck
// too.
void writeTextFile(MPI_Comm comm, const std::string& path, const std::string& text);
// Collective: rank 0 removes the file if it is there; throws OutputError on every rank when that fails.
void removeFile(MPI_Comm comm, const std::string& path);
// Collective: rank 0 makes the folder and those above it; throws OutputError when that fails.
void makeDirectory(MPI_Comm comm, const std::string& path);

// Table of phases, FOM line, and last line PASS or FAIL: why. For rank 0's standard output.
void printReport(std::ostream& out, const RunReport& report);

} // namespace brickwall::miniapp
