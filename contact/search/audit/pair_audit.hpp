// An audit of lists of candidate pairs: every face of every rank against every node, by plain loops. For tests of a run that
// matters, not for every step: the work is that of nodes times faces.
#pragma once

#include "contact/surface/search_config.hpp"
#include "contact/surface/surface.hpp"

#include <mpi.h>

#include <cstdint>

namespace brickwall::contact {

// Number of pairs, over all ranks, whose boxes of this step overlap at the tolerances of `config` and which the rules do not
// exclude, but which `pairs` does not list (or, of kept lists, which its step test would not let through). Shares with the
// searches only the definition of a box. Every rank's faces go to all ranks in turn: memory for those of the largest rank.
// Collective.
std::int64_t countMissedPairs(const exec_space& space, MPI_Comm comm, const SweptBoxes& surface,
                              const GhostFaces& ghosts, const CandidatePairs& pairs,
                              const SearchConfig& config);

} // namespace brickwall::contact
