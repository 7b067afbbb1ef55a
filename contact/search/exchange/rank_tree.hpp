// Partners by a binary tree over the numbers of the ranks, so that no rank holds or tests a list of
// all: the leaves are ranks, an inner node is a group of consecutive ranks with the union of their
// boxes. Upwards each rank learns the boxes of the groups beside its own; downwards boxes travel to
// the groups that they overlap. Messages only, no MPI: the caller carries them, over a network or,
// for many virtual ranks, within one process.
// Costs: theory.md, section 3.1.
#pragma once

#include "contact/base/box.hpp"
#include "contact/surface/construct_boxes.hpp"

#include <cstdint>
#include <vector>

namespace brickwall::contact {

// The boxes of a rank as sent.
struct RankRecord {
  int rank = 0;
  Box node_box, face_box; // Bbar_n, Bbar_f
};

// What is known of a group of ranks; of a single one if it has just been made.
struct RankGroup {
  static constexpr std::int64_t none = -1;

  Box node_box, face_box; // the unions
  std::int64_t num_invalid = 0; // nodes with a coordinate that is not finite
  std::int64_t first_invalid = 0, invalid_rank = none; // the smallest id of these, and its rank
  // The lowest rank with faces and its number of face attributes; the lowest one with another
  // number.
  std::int64_t rank_with_faces = none, attributes = 0;
  std::int64_t other_rank = none, other_attributes = 0;

  // Adds a group of higher ranks.
  void include(const RankGroup& higher);
};

class RankTree {
public:
  // A leaf, or position, of the tree is one rank or, with `size` not a power of two, one or two:
  // the second one, the guest, takes part in the first round and the last only. Groups are the
  // halves of halves of the ranks, as in the bisection that places them.
  RankTree(int rank, int size);

  // The messages of this rank in each of the rounds, whose number is the same on all ranks: at most
  // one to `peer` and one from it.
  struct Round {
    int peer = -1;
    bool sends = false, receives = false;
  };
  int numRounds() const { return 2 * _levels + (_is_uneven ? 2 : 0); }
  Round round(int i) const;

  // Before the first round; `own` is of this rank alone.
  void begin(const RankRecord& record, const RankGroup& own);
  // The message of round i; the one received in it.
  void pack(int i, std::vector<std::int64_t>& words);
  void unpack(int i, const std::int64_t* words, std::size_t size);

  // After the last round. The other ranks whose face box overlaps the node box of this one or whose
  // node box overlaps its face box, ascending.
  std::vector<RankRecord> partners();
  const RankGroup& all() const { return _groups.back(); } // ranks
  std::int64_t boxTests() const { return _box_tests; } // since begin()

private:
  enum class Part { join, up, down, leave, none };
  struct Place {
    Part part = Part::none;
    int level = 0;
  };
  Place placeOf(int round) const;
  int firstRankAt(int position) const;
  int peerAt(int level) const; // the rank that stands for the group beside this one's
  bool overlap(const RankRecord& a, const Box& node_box, const Box& face_box);
  void receiveRecords(const std::int64_t* words, std::size_t size);

  int _rank, _size, _levels = 0;
  bool _is_uneven = false;
  bool _is_guest = false, _is_host = false; // the second and the first of two ranks
  int _position = 0; // among the 2^levels that take part
  RankRecord _own;
  RankGroup _own_group;
  RankRecord _guest_record;
  // [level] of the 2^level positions around this one's; the last is of all ranks.
  std::vector<RankGroup> _groups;
  std::vector<RankGroup> _beside; // [level] of the 2^level positions that join those at level + 1
  std::vector<RankRecord> _held, _kept; // boxes that may overlap those of the present group
  std::int64_t _box_tests = 0;
};

} // namespace brickwall::contact
