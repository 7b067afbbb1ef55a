#include "contact/search/audit/pair_motion.hpp"

#include "contact/surface/face_access.hpp"

namespace brickwall::contact {
namespace {

// Motion of nodes relative to the four corners of faces.
struct NodeAndFace {
  FaceAccess faces;
  KOKKOS_INLINE_FUNCTION double squaredMotion(int node, int face) const {
    const Vec3 of_node = faces.nodeMotion(node);
    double largest = 0;
    for (int corner = 0; corner < 4; ++corner) {
      const Vec3 against = of_node - faces.cornerMotion(face, corner);
      largest = maxOf(largest, dot(against, against));
    }
    return largest;
  }
  KOKKOS_INLINE_FUNCTION global_id idOf(int node) const { return faces.surface.node_ids(node); }
};

// Motion of the ends of edges, corners 0 and 1, relative to each other.
struct EdgeAndEdge {
  FaceAccess faces;
  int num_corners;
  KOKKOS_INLINE_FUNCTION double squaredMotion(int node, int other) const {
    const int own = node - num_corners;
    double largest = 0;
    for (int a = 0; a < 2; ++a)
      for (int b = 0; b < 2; ++b) {
        const Vec3 against = faces.cornerMotion(own, a) - faces.cornerMotion(other, b);
        largest = maxOf(largest, dot(against, against));
      }
    return largest;
  }
  KOKKOS_INLINE_FUNCTION global_id idOf(int node) const {
    return faces.surface.face_ids(node - num_corners);
  }
};

template <class Pair>
struct FindFastest {
  Pair pair_of;
  CandidatePairs pairs;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t row, LeadingPair& all) const {
    const int node = pairs.node(row);
    for (std::int64_t pair = pairs.begin(row); pair < pairs.end(row); ++pair) {
      const int face = pairs.faces(pair);
      LeadingPair one;
      one.value = pair_of.squaredMotion(node, face);
      if (one.value < all.value || !pair_of.faces.isOfThisStep(pairs.step_test, node, face))
        continue;
      one.pair = {pair_of.idOf(node), pair_of.faces.id(face), pair_of.faces.surface.node_body(node),
                  pair_of.faces.body(face)};
      all += one;
    }
  }
};

template <class Pair>
PairMotion fastestOf(const exec_space& space, MPI_Comm comm, const Pair& pair_of,
                     const CandidatePairs& pairs, double limit) {
  LeadingPair local;
  Kokkos::parallel_reduce("contact::fastestPair", rangePolicy(space, pairs.num_rows),
                          FindFastest<Pair>{pair_of, pairs}, PlusReducer<LeadingPair>(local));
  space.fence();
  const double square = allReduce(comm, local.value, MPI_MAX);
  PairMotion fastest;
  fastest.motion = std::sqrt(square);
  if (fastest.motion > limit)
    static_cast<PairIds&>(fastest) = pairOfLeader(comm, local, square);
  return fastest;
}

} // namespace

PairMotion fastestPair(const exec_space& space, MPI_Comm comm, const SweptBoxes& surface,
                       const GhostFaces& ghosts, const CandidatePairs& pairs, double limit) {
  return fastestOf(space, comm, NodeAndFace{{surface, ghosts}}, pairs, limit);
}

PairMotion fastestEdgePair(const exec_space& space, MPI_Comm comm, const SweptBoxes& edges,
                           int num_corners, const GhostFaces& ghosts, const CandidatePairs& pairs,
                           double limit) {
  PairMotion fastest =
      fastestOf(space, comm, EdgeAndEdge{{edges, ghosts}, num_corners}, pairs, limit);
  fastest.is_of_edges = true;
  return fastest;
}

} // namespace brickwall::contact
