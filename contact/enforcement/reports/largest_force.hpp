// The contact with the largest force, reported when contact forces exceed the range of the fixed
// point.
#pragma once

#include "contact/enforcement/law/contact_history.hpp"
#include "contact/surface/leading_pair.hpp"
#include "contact/surface/surface.hpp"

#include <mpi.h>

namespace brickwall::contact {

// Edges are numbered 4 * face + side of the face, as in pair_motion.hpp.
struct LargestForce : PairIds {
  double force = 0; // normal force with damping; infinite if not finite; 0 without contacts
  bool is_of_edges = false;
};

// The largest force over all interactions of all ranks, before or after the corrections; ties go to
// the lowest ids. Collective.
LargestForce largestForce(const exec_space& space, MPI_Comm comm, const SweptBoxes& surface,
                          const ContactHistory& history);

// The same for edge-to-edge contact: surface and history of an EdgeContact, where row num_corners +
// e stands for edge e.
LargestForce largestEdgeForce(const exec_space& space, MPI_Comm comm, const SweptBoxes& edges,
                              int num_corners, const ContactHistory& history);

} // namespace brickwall::contact
