// Phase 2: every rank learns the rank boxes of all ranks, and that all coordinates are finite.
#pragma once

#include "contact/construct_boxes.hpp"

#include <mpi.h>

#include <vector>

namespace brickwall::contact {

struct RankBoxes {
  int rank = 0; // this one
  int size = 1;
  std::vector<Box> node_boxes; // [rank] Bbar_n
  std::vector<Box> face_boxes; // [rank] Bbar_f
  // Values per face that ghosts carry along, the same on all ranks that have faces.
  int num_attributes = 0;

private:
  friend void exchangeRankBoxes(MPI_Comm, const Surface&, const SurfaceBoxes&, RankBoxes&);
  std::vector<std::int64_t> _words; // [rank][word] as gathered
};

// Collective. Throws PhysicsError on all ranks if any has a coordinate that is not finite (the smallest node id, the
// lowest rank that has it), InputError if the numbers of face attributes differ.
void exchangeRankBoxes(MPI_Comm comm, const Surface& surface, const SurfaceBoxes& boxes,
                       RankBoxes& all);

} // namespace brickwall::contact
