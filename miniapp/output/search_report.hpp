// The report of `brickwall search`: search.json (its field names are fixed), the printed table, the
// FOM line and PASS.
#pragma once

#include "miniapp/output/report.hpp"
#include "miniapp/timing/phase_recorder.hpp"

#include <mpi.h>

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

namespace brickwall::miniapp {

// A number of bytes on each rank.
struct RankBytes {
  std::int64_t max = 0, sum = 0; // over the ranks
};
// Collective.
RankBytes overRanks(MPI_Comm comm, std::int64_t bytes);

// Seconds per counted repetition, those that kept their lists (search.reuse) included.
struct SearchTimes {
  StepStatistics whole; // from the boxes to the list of pairs
  StepStatistics global; // findGhosts: the paper's six phases, migration included
  StepStatistics local; // findCandidatePairs
};

struct SearchOnlyReport {
  std::string case_name, title;
  Provenance provenance;
  std::int64_t nodes = 0, faces = 0; // all ranks
  std::string method;
  Timing timing = Timing::normal;
  bool with_local_search = true; // without it, its numbers are 0
  bool shuffled = false; // local node and face order was permuted
  double jitter = 0, drift = 0; // over an edge
  std::int64_t seed = 0, warmup = 0, repetitions = 0;
  double margin = 0; // search.reuse.margin
  std::int64_t searches = 0; // among the repetitions; the others kept the lists

  double first_seconds = 0; // the first search, which allocates and sorts; slowest rank
  SearchTimes seconds;
  // CPU seconds of all threads of a rank; with Timing::paper, those of waiting for other ranks are
  // excluded.
  SearchTimes cpu_seconds;
  std::vector<PhaseSteps> timers; // the 13, own seconds per search
  std::vector<PhaseTime> phases; // sums over the counted searches

  // In the last search, all ranks.
  std::int64_t ghost_faces = 0, candidate_pairs = 0;
  std::int64_t node_boxes_sent = 0; // L_gns
  std::int64_t faces_tested = 0; // L_gfs: tested against remote nodes
  std::int64_t overlapping_pairs = 0; // in search 2, before its filter
  std::int64_t most_partners = 0; // largest number of partners of a rank

  // Faces, and of the last search ghost faces and candidate pairs; the time of the counted searches
  // without waits for other ranks.
  std::vector<RankValue> over_ranks;

  RankBytes peak; // whole process, set-up included
  RankBytes inputs; // resident before the first search: program, libraries and surface
  RankBytes search; // peak of the searches above that

  double faceSearchesPerSecond() const; // 0 where no time was measured
};

// The report as JSON text.
std::string searchReportJson(const SearchOnlyReport& report);

// Table of timers, FOM line and PASS. For the standard output of rank 0.
void printSearchReport(std::ostream& out, const SearchOnlyReport& report);

} // namespace brickwall::miniapp
