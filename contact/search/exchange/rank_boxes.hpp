// Phase 2: every rank learns the rank boxes of all ranks, and that all coordinates are finite.
#pragma once

#include "contact/surface/construct_boxes.hpp"

#include <mpi.h>

#include <vector>

namespace brickwall::contact {

struct RankBoxes {
  int rank = 0; // this one
  int size = 1;
  std::vector<Box> node_boxes; // [rank] Bbar_n
  std::vector<Box> face_boxes; // [rank] Bbar_f
  // Words per face that ghosts carry along, the same on all ranks that have faces.
  int num_attributes = 0;

private:
  friend void exchangeRankBoxes(MPI_Comm, const SweptBoxes&, const OwnRankBoxes&, RankBoxes&);
  std::vector<std::int64_t> _words; // [rank][word] as gathered
};

// Collective. Throws PhysicsError on all ranks if any has a coordinate that is not finite (naming
// the smallest node id and the rank that has it), InputError if the numbers of face attributes
// differ.
void exchangeRankBoxes(MPI_Comm comm, const SweptBoxes& surface, const OwnRankBoxes& own,
                       RankBoxes& all);

// Partners: the ranks other than this one whose box, in `boxes` [rank], overlaps `own`. Ascending.
void findPartners(const Box& own, const std::vector<Box>& boxes, int this_rank,
                  std::vector<int>& ranks);

} // namespace brickwall::contact
