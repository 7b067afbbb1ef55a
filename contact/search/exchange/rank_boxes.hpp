// Phase 2: every rank learns the rank boxes of all ranks, and that all coordinates are finite. Boxes
// that are sent with a margin hold until a surface leaves one; nothing grows with the number of
// ranks in the steps between.
#pragma once

#include "contact/surface/construct_boxes.hpp"

#include <mpi.h>

#include <vector>

namespace brickwall::contact {

struct RankBoxes {
  int rank = 0; // this one
  int size = 1;
  std::vector<Box> node_boxes; // [rank] Bbar_n as sent, with the margin
  std::vector<Box> face_boxes; // [rank] Bbar_f likewise
  // Partners: the other ranks whose face box overlaps the node box of this rank (Q_snd), and those
  // whose node box overlaps its face box (Q_rcv). Ascending.
  std::vector<int> near_nodes, near_faces;
  // Words per face that ghosts carry along, the same on all ranks that have faces.
  int num_attributes = 0;

  // Whether what this rank has sent still holds: its boxes contain the present ones, which are
  // finite, and faces have as many attributes.
  bool hold(const SweptBoxes& surface, const OwnRankBoxes& own) const;

private:
  friend void exchangeRankBoxes(MPI_Comm, const SweptBoxes&, const OwnRankBoxes&, bool, RankBoxes&);
  void gather(MPI_Comm comm, const SweptBoxes& surface, const OwnRankBoxes& own, bool with_margin);

  std::vector<std::int64_t> _words; // [rank][word] as gathered
};

// Collective. Sends the boxes, with a margin of a hundredth of their longest side if `with_margin`.
// Throws PhysicsError on all ranks if any has a coordinate that is not finite (naming the smallest
// node id and the rank that has it), InputError if the numbers of face attributes differ.
void exchangeRankBoxes(MPI_Comm comm, const SweptBoxes& surface, const OwnRankBoxes& own,
                       bool with_margin, RankBoxes& all);

} // namespace brickwall::contact
