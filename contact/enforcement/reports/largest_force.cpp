#include "contact/enforcement/reports/largest_force.hpp"

namespace brickwall::contact {
namespace {

KOKKOS_INLINE_FUNCTION double forceOf(const Interaction& pair) {
  const double force = maxOf(std::fabs(pair.force), std::fabs(pair.first_force)) +
                       maxOf(std::fabs(pair.damping), std::fabs(pair.first_damping));
  return force <= HUGE_VAL ? force : HUGE_VAL; // a NaN is out of range, too
}

// `ids` [row - first_row]: global ids of the pushing nodes or edges.
LargestForce largestOf(const exec_space& space, MPI_Comm comm, const SweptBoxes& surface,
                       const View<const global_id*>& ids, int first_row,
                       const ContactHistory& history) {
  const auto interactions = history.interactions;
  const auto node_body = surface.node_body;
  LeadingPair local;
  Kokkos::parallel_reduce(
      "contact::largestForce", rangePolicy(space, history.count),
      KOKKOS_LAMBDA(const std::int64_t i, LeadingPair& all) {
        const Interaction& pair = interactions(i);
        LeadingPair one;
        one.value = forceOf(pair);
        one.pair = {ids(pair.node - first_row), pair.face, node_body(pair.node),
                    bodyOfSide(pair.side)};
        all += one;
      },
      PlusReducer<LeadingPair>(local));
  const LeadingPair leader = leaderOfAll(comm, local);
  return {leader.pair, leader.value};
}

} // namespace

LargestForce largestForce(const exec_space& space, MPI_Comm comm, const SweptBoxes& surface,
                          const ContactHistory& history) {
  return largestOf(space, comm, surface, surface.node_ids, 0, history);
}

LargestForce largestEdgeForce(const exec_space& space, MPI_Comm comm, const SweptBoxes& edges,
                              int num_corners, const ContactHistory& history) {
  LargestForce largest = largestOf(space, comm, edges, edges.face_ids, num_corners, history);
  largest.is_of_edges = true;
  return largest;
}

} // namespace brickwall::contact
