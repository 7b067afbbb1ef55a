// The pair of a node and a face (or of two edges) with the greatest value of some quantity over all
// ranks.
#pragma once

#include "contact/base/mpi.hpp"

#include <cstdint>

namespace brickwall::contact {

// Global ids.
struct PairIds {
  global_id node = -1, face = -1; // node and face, or edge and edge
  global_id node_body = -1, face_body = -1;
};

// For reductions: the greatest value; among equal values the lowest node, then face.
struct LeadingPair {
  double value = 0;
  PairIds pair{INT64_MAX, INT64_MAX, -1, -1};

  KOKKOS_INLINE_FUNCTION bool isBefore(const LeadingPair& b) const {
    if (value != b.value)
      return value > b.value;
    return pair.node != b.pair.node ? pair.node < b.pair.node : pair.face < b.pair.face;
  }
  KOKKOS_INLINE_FUNCTION LeadingPair& operator+=(const LeadingPair& b) {
    if (b.isBefore(*this))
      *this = b;
    return *this;
  }
};

// The leading pair of all ranks; `value` is the greatest value of all `local` pairs. Collective.
inline PairIds pairOfLeader(MPI_Comm comm, const LeadingPair& local, double value) {
  const auto lowest = [&](bool takes_part, global_id id) {
    return allReduce(comm, takes_part ? id : INT64_MAX, MPI_MIN);
  };
  PairIds leader;
  const bool has_value = local.value == value;
  leader.node = lowest(has_value, local.pair.node);
  const bool has_node = has_value && local.pair.node == leader.node;
  leader.face = lowest(has_node, local.pair.face);
  const bool has_pair = has_node && local.pair.face == leader.face;
  leader.node_body = lowest(has_pair, local.pair.node_body);
  leader.face_body = lowest(has_pair, local.pair.face_body);
  return leader;
}

// The leading pair of all ranks with its value; without a pair if no value is above 0. Collective.
inline LeadingPair leaderOfAll(MPI_Comm comm, const LeadingPair& local) {
  LeadingPair leader;
  leader.value = allReduce(comm, local.value, MPI_MAX);
  leader.pair = leader.value > 0 ? pairOfLeader(comm, local, leader.value) : PairIds();
  return leader;
}

} // namespace brickwall::contact
