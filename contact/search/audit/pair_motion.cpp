#include "contact/search/audit/pair_motion.hpp"

#include "contact/surface/face_access.hpp"

namespace brickwall::contact {
namespace {

// Whether a corner of a face is fast; true of ghosts, whose corners have no flags.
KOKKOS_INLINE_FUNCTION bool isCornerFast(const View<const unsigned char*>& nodes,
                                         const FaceAccess& faces, int face) {
  if (!faces.isOwn(face))
    return true;
  int any = 0;
  for (int corner = 0; corner < 4; ++corner)
    any |= nodes(faces.surface.face_to_nodes(face, corner));
  return any != 0;
}

// Motion of nodes relative to the four corners of faces.
struct NodeAndFace {
  FaceAccess faces;
  KOKKOS_INLINE_FUNCTION bool isFast(const View<const unsigned char*>& nodes, int node) const {
    return nodes(node) != 0;
  }
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
  KOKKOS_INLINE_FUNCTION bool isFast(const View<const unsigned char*>& nodes, int node) const {
    return isCornerFast(nodes, faces, node - num_corners);
  }
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

// Flags nodes that move by more than sqrt(square) relative to `mean`.
struct FlagFast {
  View<const double*[3]> x_old, x_new;
  Vec3 mean;
  double square;
  View<unsigned char*> is_fast;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t node) const {
    const Vec3 motion = rowOf(x_new, node) - rowOf(x_old, node) - mean;
    is_fast(node) = !(dot(motion, motion) <= square);
  }
};

template <class Pair>
struct FindFastest {
  Pair pair_of;
  CandidatePairs pairs;
  View<const unsigned char*> is_fast;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t row, LeadingPair& all) const {
    const int node = pairs.node(row);
    if (pairs.begin(row) == pairs.end(row))
      return;
    const bool is_node_fast = pair_of.isFast(is_fast, node);
    for (std::int64_t pair = pairs.begin(row); pair < pairs.end(row); ++pair) {
      const int face = pairs.faces(pair);
      if (!is_node_fast && !isCornerFast(is_fast, pair_of.faces, face))
        continue;
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
                     const CandidatePairs& pairs, const Vec3& mean, double limit,
                     View<unsigned char*>& is_fast) {
  const SweptBoxes& surface = pair_of.faces.surface;
  const auto num_nodes = static_cast<std::int64_t>(surface.num_nodes);
  constexpr double share = 0.499; // less than half of the limit by more than rounding
  growTo(space, is_fast, num_nodes);
  Kokkos::parallel_for("contact::FastestPair::flagFast", rangePolicy(space, num_nodes),
                       FlagFast{surface.coordinates_old, surface.coordinates_new, mean,
                                share * limit * share * limit, is_fast});
  LeadingPair local;
  Kokkos::parallel_reduce("contact::FastestPair::find", rangePolicy(space, pairs.num_rows),
                          FindFastest<Pair>{pair_of, pairs, is_fast},
                          PlusReducer<LeadingPair>(local));
  const double square = allReduce(comm, local.value, MPI_MAX);
  PairMotion fastest;
  fastest.motion = std::sqrt(square);
  if (fastest.motion > limit)
    static_cast<PairIds&>(fastest) = pairOfLeader(comm, local, square);
  return fastest;
}

} // namespace

PairMotion FastestPair::find(const exec_space& space, MPI_Comm comm, const SweptBoxes& surface,
                             const GhostFaces& ghosts, const CandidatePairs& pairs,
                             const Vec3& mean, double limit) {
  return fastestOf(space, comm, NodeAndFace{{surface, ghosts}}, pairs, mean, limit, _is_fast);
}

PairMotion FastestPair::findEdges(const exec_space& space, MPI_Comm comm, const SweptBoxes& edges,
                                  int num_corners, const GhostFaces& ghosts,
                                  const CandidatePairs& pairs, const Vec3& mean, double limit) {
  PairMotion fastest = fastestOf(space, comm, EdgeAndEdge{{edges, ghosts}, num_corners}, pairs,
                                 mean, limit, _is_fast);
  fastest.is_of_edges = true;
  return fastest;
}

} // namespace brickwall::contact
