// Audit of lists of candidate pairs: every face of every rank against every node, by plain loops.
// For the verification of important runs, not for every step: the cost is proportional to nodes
// times faces.
#pragma once

#include "contact/surface/search_config.hpp"
#include "contact/surface/surface.hpp"

#include <mpi.h>

#include <cstdint>

namespace brickwall::contact {

// Number of pairs, over all ranks, whose boxes of this step overlap at the tolerances of `config`
// and which the rules do not exclude, but which `pairs` does not list (or, for kept lists, which
// its step test rejects). The audit shares only the definition of a box with the searches. The
// faces of each rank are sent to all ranks in turn, which needs memory for those of the largest
// rank. Collective.
std::int64_t countMissedPairs(const exec_space& space, MPI_Comm comm, const SweptBoxes& surface,
                              const GhostFaces& ghosts, const CandidatePairs& pairs,
                              const SearchConfig& config);

} // namespace brickwall::contact
