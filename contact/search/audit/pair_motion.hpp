// How fast nodes and faces, or edges and edges, that may touch move against each other in one step: where that is more than the
// search reaches, one may have passed the other unseen, or lie too deep to be found again.
#pragma once

#include "contact/surface/leading_pair.hpp"
#include "contact/surface/surface.hpp"

#include <mpi.h>

namespace brickwall::contact {

// The pair whose node (an end of the edge that pushes) moves most against a corner of its face (an end of its edge); of equals
// that of the lowest ids.
// The ids are set where `motion` is beyond the limit asked for; edges are numbered 4 * face + side of the face.
struct PairMotion : PairIds {
  double motion = 0; // |(x^{n+1} - x^n) of the one - that of the other|, length; 0 without pairs
  bool is_of_edges = false;
};

// The fastest of all candidate pairs of this step on all ranks, the same on every rank and for any margin of the search.
// Collective: one reduction of one number, and some more where the motion is beyond `limit`.
PairMotion fastestPair(const exec_space& space, MPI_Comm comm, const SweptBoxes& surface,
                       const GhostFaces& ghosts, const CandidatePairs& pairs, double limit);

// The same of edges: the surface, ghosts and pairs of an EdgeContact, where row num_corners + e stands for edge e.
PairMotion fastestEdgePair(const exec_space& space, MPI_Comm comm, const SweptBoxes& edges,
                           int num_corners, const GhostFaces& ghosts, const CandidatePairs& pairs,
                           double limit);

} // namespace brickwall::contact
