#include "contact/pair_motion.hpp"

#include "contact/base/mpi.hpp"
#include "contact/face_access.hpp"

namespace brickwall::contact {
namespace {

struct Fastest {
  double square = 0; // of the motion
  global_id node = INT64_MAX, face = INT64_MAX;
  global_id node_body = -1, face_body = -1;

  KOKKOS_INLINE_FUNCTION bool isBefore(const Fastest& b) const {
    if (square != b.square)
      return square > b.square;
    return node != b.node ? node < b.node : face < b.face;
  }
  KOKKOS_INLINE_FUNCTION Fastest& operator+=(const Fastest& b) {
    if (b.isBefore(*this))
      *this = b;
    return *this;
  }
};

// Nodes against the four corners of faces.
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

// Ends of edges against ends of edges: corners 0 and 1.
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

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t row, Fastest& all) const {
    const int node = pairs.node(row);
    for (std::int64_t pair = pairs.begin(row); pair < pairs.end(row); ++pair) {
      const int face = pairs.faces(pair);
      Fastest one;
      one.square = pair_of.squaredMotion(node, face);
      if (one.square < all.square || !isOfThisStep(node, face))
        continue;
      one.node = pair_of.idOf(node);
      one.face = pair_of.faces.id(face);
      one.node_body = pair_of.faces.surface.node_body(node);
      one.face_body = pair_of.faces.body(face);
      all += one;
    }
  }
  // Lists with a margin hold more pairs than a search in this step would list.
  KOKKOS_INLINE_FUNCTION bool isOfThisStep(int node, int face) const {
    const StepTest& test = pairs.step_test;
    return !test.is_needed ||
           pair_of.faces.boxesOverlap(node, face, test.node_tolerance, test.face_tolerance);
  }
};

template <class Pair>
PairMotion fastestOf(const exec_space& space, MPI_Comm comm, const Pair& pair_of,
                     const CandidatePairs& pairs, double limit) {
  Fastest local;
  Kokkos::parallel_reduce("contact::fastestPair", over(space, pairs.num_rows),
                          FindFastest<Pair>{pair_of, pairs}, Combine<Fastest>(local));
  space.fence();
  const double square = allReduce(comm, local.square, MPI_MAX);
  PairMotion fastest;
  fastest.motion = std::sqrt(square);
  if (!(fastest.motion > limit))
    return fastest;
  const auto lowest = [&](bool takes_part, global_id id) {
    return allReduce(comm, takes_part ? id : INT64_MAX, MPI_MIN);
  };
  fastest.node = lowest(local.square == square, local.node);
  const bool has_node = local.square == square && local.node == fastest.node;
  fastest.face = lowest(has_node, local.face);
  const bool has_pair = has_node && local.face == fastest.face;
  fastest.node_body = lowest(has_pair, local.node_body);
  fastest.face_body = lowest(has_pair, local.face_body);
  return fastest;
}

} // namespace

PairMotion fastestPair(const exec_space& space, MPI_Comm comm, const Surface& surface,
                       const GhostFaces& ghosts, const CandidatePairs& pairs, double limit) {
  return fastestOf(space, comm, NodeAndFace{{surface, ghosts}}, pairs, limit);
}

PairMotion fastestEdgePair(const exec_space& space, MPI_Comm comm, const Surface& edges,
                           int num_corners, const GhostFaces& ghosts, const CandidatePairs& pairs,
                           double limit) {
  PairMotion fastest =
      fastestOf(space, comm, EdgeAndEdge{{edges, ghosts}, num_corners}, pairs, limit);
  fastest.is_of_edges = true;
  return fastest;
}

} // namespace brickwall::contact
