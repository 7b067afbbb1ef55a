// Phase 2: every rank learns which rank boxes overlap its own, and that all coordinates are finite.
// Boxes that are sent with a margin hold until a surface leaves one: the steps between send
// nothing, and an exchange takes 2 log2(P) messages of each of P ranks (rank_tree.hpp).
#pragma once

#include "contact/surface/construct_boxes.hpp"

#include <mpi.h>

#include <vector>

namespace brickwall::contact {

// Other ranks, ascending, each with its box as sent.
struct NearRanks {
  std::vector<int> ranks;
  std::vector<Box> boxes;

  void clear() {
    ranks.clear();
    boxes.clear();
  }
  void add(int rank, const Box& box) {
    ranks.push_back(rank);
    boxes.push_back(box);
  }
};

struct RankBoxes {
  // Boxes of this rank as sent, with the margin: Bbar_n, Bbar_f.
  Box node_box, face_box;
  // Partners: the ranks whose face box overlaps the node box of this rank, with these face boxes
  // (Q_snd), and those whose node box overlaps its face box, with these node boxes (Q_rcv).
  NearRanks near_nodes, near_faces;
  // Words per face that ghosts carry along, the same on all ranks that have faces.
  int num_attributes = 0;

  // Whether what this rank has sent still holds: its boxes contain the present ones, which are
  // finite, and faces have as many attributes.
  bool hold(const SweptBoxes& surface, const OwnRankBoxes& own) const;
  bool areKnown() const { return _are_known; } // from an exchange

private:
  friend void exchangeRankBoxes(MPI_Comm, const SweptBoxes&, const OwnRankBoxes&, bool, RankBoxes&);

  bool _are_known = false;
  std::int64_t _sent_attributes = 0;
};

// Collective. With `keeps`, sends the boxes with a margin of a hundredth of their longest side
// along the tree of ranks; otherwise all ranks learn the boxes of all, as in the paper.
// Throws PhysicsError on all ranks if any has a coordinate that is not finite (naming the smallest
// node id and the rank that has it), InputError if the numbers of face attributes differ.
void exchangeRankBoxes(MPI_Comm comm, const SweptBoxes& surface, const OwnRankBoxes& own,
                       bool keeps, RankBoxes& all);

} // namespace brickwall::contact
