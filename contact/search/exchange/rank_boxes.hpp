// Phase 2: every rank learns the rank boxes of all ranks, and that all coordinates are finite.
#pragma once

#include "contact/search/cluster/surface_clusters.hpp"
#include "contact/surface/construct_boxes.hpp"

#include <mpi.h>

#include <vector>

namespace brickwall::contact {

// What a rank tells the others.
struct OwnRankBoxes {
  Box node_box, face_box;
  std::int64_t num_invalid = 0; // nodes with a coordinate that is not finite
  global_id first_invalid = 0; // smallest global id of those
};

struct RankBoxes {
  int rank = 0; // this one
  int size = 1;
  std::vector<Box> node_boxes; // [rank] Bbar_n
  std::vector<Box> face_boxes; // [rank] Bbar_f
  // Values per face that ghosts carry along, the same on all ranks that have faces.
  int num_attributes = 0;

private:
  friend void exchangeRankBoxes(MPI_Comm, const Surface&, const OwnRankBoxes&, RankBoxes&);
  std::vector<std::int64_t> _words; // [rank][word] as gathered
};

// Collective. Throws PhysicsError on all ranks if any has a coordinate that is not finite (the smallest node id, the
// lowest rank that has it), InputError if the numbers of face attributes differ.
void exchangeRankBoxes(MPI_Comm comm, const Surface& surface, const OwnRankBoxes& own,
                       RankBoxes& all);
void exchangeRankBoxes(MPI_Comm comm, const Surface& surface, const SurfaceBoxes& boxes,
                       RankBoxes& all);
void exchangeRankBoxes(MPI_Comm comm, const Surface& surface, const SurfaceClusters& clusters,
                       RankBoxes& all);

// Partners: the ranks other than this one whose box, of `boxes` [rank], meets `own`. Ascending.
void findPartners(const Box& own, const std::vector<Box>& boxes, int this_rank,
                  std::vector<int>& ranks);

} // namespace brickwall::contact
