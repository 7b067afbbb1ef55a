// Results of the search as global ids on the host: for inspection, tests and comparisons, not for
// time steps.
#pragma once

#include "contact/surface/surface.hpp"

#include <vector>

namespace brickwall::contact {

// A node that may touch a face.
struct IdPair {
  global_id node = 0, face = 0;
};

// The candidate pairs of this rank's owned nodes, rows in their order. Not collective; copies
// everything to the host.
std::vector<IdPair> candidateIds(const exec_space& space, const SweptBoxes& surface,
                                 const GhostFaces& ghosts, const CandidatePairs& pairs);

} // namespace brickwall::contact
