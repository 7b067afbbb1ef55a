// The greatest motion, in one step, of nodes and faces or of pairs of edges that may meet in the
// step. Where it exceeds the reach of the search, one may have passed through the other without
// being detected, or may lie too deep to be detected later.
#pragma once

#include "contact/base/vec3.hpp"
#include "contact/surface/leading_pair.hpp"
#include "contact/surface/surface.hpp"

#include <mpi.h>

namespace brickwall::contact {

// The pair whose node moves most towards the inside of its face, or whose edges' ends move most
// relative to each other; among equal motions that of the lowest ids. The ids are set where `motion`
// exceeds the given limit; edges have the id 4 * face + side of the face.
struct PairMotion : PairIds {
  double motion = 0; // length
  bool is_of_edges = false;
};

// Finds the fastest of all candidate pairs of a step on all ranks: the same on every rank and for
// any margin of the search, if its motion exceeds `limit`; otherwise none, which moves by 0.
// Pairs whose nodes all move by less than half the limit relative to `mean` are passed over, so
// that any mean is correct, and one that most nodes follow is fast; length. Collective: one
// reduction of one number, and further ones where the motion exceeds the limit.
class FastestPair {
public:
  PairMotion find(const exec_space& space, MPI_Comm comm, const SweptBoxes& surface,
                  const GhostFaces& ghosts, const CandidatePairs& pairs, const Vec3& mean,
                  double limit);
  // The same for the boxes, ghosts and pairs of an EdgeContact, where node num_corners + e is edge
  // e.
  PairMotion findEdges(const exec_space& space, MPI_Comm comm, const SweptBoxes& edges,
                       int num_corners, const GhostFaces& ghosts, const CandidatePairs& pairs,
                       const Vec3& mean, double limit);

private:
  View<unsigned char*> _is_fast; // [node]; without meaning between calls
};

} // namespace brickwall::contact
