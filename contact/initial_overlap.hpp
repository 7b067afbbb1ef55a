// Bodies that stand in each other before anything has moved.
#pragma once

#include "contact/leading_pair.hpp"
#include "contact/surface.hpp"

#include <mpi.h>

namespace brickwall::contact {

// The face is the nearest of the body that the node is in.
struct InitialOverlap : PairIds {
  double depth = 0; // length; 0: no node is inside another body
};

// The node that is deepest inside another body, at coordinates_new, of those no deeper than about 2 `reach` (length). A node is
// inside if the nearest point of the body's faces lies on the face, not on its rim, and the node behind it. Of equal depths the
// lowest node, then face. A set-up task: one search with wide boxes. Collective.
InitialOverlap deepestOverlap(const exec_space& space, MPI_Comm comm, const Surface& surface,
                              double reach);

} // namespace brickwall::contact
