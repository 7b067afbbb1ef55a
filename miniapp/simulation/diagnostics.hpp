// Diagnostics of a simulation for reports, limits and tests.
#pragma once

#include "miniapp/simulation/simulation.hpp"

#include <cstdint>
#include <string>

namespace brickwall::miniapp {

// Counts of the last step over all ranks, or since the start where stated.
struct ContactCounts {
  std::int64_t searches = 0; // since the start
  std::int64_t updates = 0; // likewise: searches and steps that kept the lists of the last one
  std::int64_t rank_box_exchanges = 0; // since the start or the restart
  std::int64_t distributions = 0; // of faces over ranks, likewise
  std::int64_t ghost_faces = 0;
  std::int64_t candidate_pairs = 0;
  std::int64_t active = 0;
  std::int64_t lost = 0; // since the start: loaded contacts that exceeded the search tolerance
  std::int64_t missed_pairs = 0; // since the start, in steps with an audit
  double max_penetration = 0; // over the square root of the face's area
  double largest_penetration = 0; // since the start
};
ContactCounts contactCounts(const Simulation& simulation); // collective

// A count or a time of this rank, and over the ranks after reduceOverRanks().
struct RankValue {
  const char* what; // e.g. "faces"
  double here = 0, max = 0, mean = 0;

  double maxOverMean() const { return mean > 0 ? max / mean : 0; }
};
// Collective, one reduction. `values` has the same entries on all ranks.
void reduceOverRanks(MPI_Comm comm, std::vector<RankValue>& values);
// Of this rank: elements and faces, and with contact ghost faces, candidate pairs of nodes and of
// edges, active contacts and those of edges among them, and the work by which contact is balanced,
// of the last step.
std::vector<RankValue> countsOfRank(const Simulation& simulation);

std::int64_t numSearches(const Simulation& simulation); // since the start

// Values of the gauges after a step, for limits. The penetration is exact when it exceeds a limit
// for the first time, otherwise a lower bound. Collective.
GaugeValues gauges(Simulation& simulation);

// A warning if the nonlinear part of the strain that linear materials neglect is large
// (mechanics/ledger/small_strain.hpp), otherwise "". Evaluated every check_interval steps and at
// the end. Collective.
std::string largeStrainWarning(const Simulation& simulation);

// Sums modulo 2^64 of hashes of all bits of the state (contact/base/hash.hpp); independent of the
// number of ranks.
struct Checksums {
  std::uint64_t nodes = 0; // displacement and velocity of every node
  // of nodes and of edges (contact/enforcement/reports/history_checksum.hpp)
  std::uint64_t contacts = 0;
  std::int64_t interactions = 0; // number of contacts
};
Checksums checksums(const Simulation& simulation); // collective
// Of the contacts of this rank; nodes are left out.
Checksums contactChecksums(const Simulation& simulation);

// Elements of all ranks that are computed in a cheaper way.
struct SpecialElements {
  std::int64_t congruent = 0; // store no geometry
  std::int64_t in_lattices = 0; // swept plane by plane
  std::int64_t free = 0; // of bricks that step by themselves
  std::int64_t resting = 0; // of bodies that nothing has moved yet
  std::int64_t skipped_steps = 0; // element-steps since the start that resting bodies have skipped
};
SpecialElements specialElements(const Simulation& simulation); // collective

// Speed of a node relative to a face up to which the tunnelling guard does not act; HUGE_VAL
// without a guard.
double sureSpeed(const Simulation& simulation);

// Message of a step that failed: names the element, the contact or the load, and a remedy where one
// is known. Before the step is undone; collective.
std::string describeFailure(const Simulation& simulation);

} // namespace brickwall::miniapp
