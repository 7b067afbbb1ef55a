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

// The vectors from the corners of one to those of another, at x^n and x^{n+1}. Between, corners move
// on straight lines, so that each vector between points of both is in the convex hull of these.
struct VectorsBetween {
  Vec3 before[4], after[4];

  // The largest square of a relative motion of corners.
  KOKKOS_INLINE_FUNCTION double squaredMotion() const {
    double largest = 0;
    for (int k = 0; k < 4; ++k)
      largest = maxOf(largest, dot(after[k] - before[k], after[k] - before[k]));
    return largest;
  }
  // False if the two are apart during the step or only move away from each other: the hull lies on
  // one side of a plane through 0.
  KOKKOS_INLINE_FUNCTION bool mayMeet() const {
    Vec3 motion = {0, 0, 0};
    double size = 0;
    for (int k = 0; k < 4; ++k) {
      motion += after[k] - before[k];
      size = maxOf(size, maxOf(dot(before[k], before[k]), dot(after[k], after[k])));
    }
    const double rounding = 1e-9 * std::sqrt(size * dot(motion, motion));
    return !(leastAlong(motion) >= -rounding) && isOnBothSides({1, 0, 0}) &&
           isOnBothSides({0, 1, 0}) && isOnBothSides({0, 0, 1});
  }

private:
  KOKKOS_INLINE_FUNCTION double leastAlong(const Vec3& direction) const {
    double least = HUGE_VAL;
    for (int k = 0; k < 4; ++k)
      least = minOf(least, minOf(dot(before[k], direction), dot(after[k], direction)));
    return least;
  }
  KOKKOS_INLINE_FUNCTION bool isOnBothSides(const Vec3& direction) const {
    return leastAlong(direction) <= 0 && leastAlong(-direction) <= 0;
  }
};

// How nodes and faces move towards each other.
struct NodeAndFace {
  FaceAccess faces;
  KOKKOS_INLINE_FUNCTION bool isFast(const View<const unsigned char*>& nodes, int node) const {
    return nodes(node) != 0;
  }
  // From the corners of the face to the node.
  KOKKOS_INLINE_FUNCTION VectorsBetween vectors(int node, int face) const {
    const Quad before = faces.oldQuad(face), after = faces.quad(face);
    VectorsBetween of_corner;
    for (int k = 0; k < 4; ++k) {
      of_corner.before[k] = rowOf(faces.surface.coordinates_old, node) - before.corner[k];
      of_corner.after[k] = rowOf(faces.surface.coordinates_new, node) - after.corner[k];
    }
    return of_corner;
  }
  // The square of the largest change of the distance from the planes of the face at its corners,
  // towards its inside.
  KOKKOS_INLINE_FUNCTION double squaredApproach(const VectorsBetween& vectors, int face) const {
    const Vec3 before = areaVector(faces.oldQuad(face)), after = areaVector(faces.quad(face));
    double inwards = 0;
    for (int k = 0; k < 4; ++k)
      inwards = maxOf(inwards, dot(vectors.before[k], before) / norm(before) -
                                   dot(vectors.after[k], after) / norm(after));
    return inwards * inwards;
  }
  KOKKOS_INLINE_FUNCTION global_id idOf(int node) const { return faces.surface.node_ids(node); }
};

// How the ends of edges, corners 0 and 1, move relative to each other.
struct EdgeAndEdge {
  FaceAccess faces;
  int num_corners;
  KOKKOS_INLINE_FUNCTION bool isFast(const View<const unsigned char*>& nodes, int node) const {
    return isCornerFast(nodes, faces, node - num_corners);
  }
  KOKKOS_INLINE_FUNCTION VectorsBetween vectors(int node, int other) const {
    const Quad own_before = faces.oldQuad(node - num_corners), before = faces.oldQuad(other);
    const Quad own_after = faces.quad(node - num_corners), after = faces.quad(other);
    VectorsBetween of_ends;
    for (int k = 0; k < 4; ++k) {
      of_ends.before[k] = own_before.corner[k / 2] - before.corner[k % 2];
      of_ends.after[k] = own_after.corner[k / 2] - after.corner[k % 2];
    }
    return of_ends;
  }
  // Edges may pass each other in any direction.
  KOKKOS_INLINE_FUNCTION double squaredApproach(const VectorsBetween&, int) const {
    return HUGE_VAL;
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
  double square; // of the limit

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t row, LeadingPair& all) const {
    const int node = pairs.node(row);
    if (pairs.begin(row) == pairs.end(row))
      return;
    const bool is_node_fast = pair_of.isFast(is_fast, node);
    for (std::int64_t pair = pairs.begin(row); pair < pairs.end(row); ++pair) {
      const int face = pairs.faces(pair);
      if (!is_node_fast && !isCornerFast(is_fast, pair_of.faces, face))
        continue;
      const VectorsBetween vectors = pair_of.vectors(node, face);
      LeadingPair one;
      one.value = vectors.squaredMotion();
      if (!mayLead(one.value, all) || !vectors.mayMeet())
        continue;
      one.value = minOf(one.value, pair_of.squaredApproach(vectors, face));
      if (!mayLead(one.value, all) || !pair_of.faces.isOfThisStep(pairs.step_test, node, face))
        continue;
      one.pair = {pair_of.idOf(node), pair_of.faces.id(face), pair_of.faces.surface.node_body(node),
                  pair_of.faces.body(face)};
      all += one;
    }
  }
  KOKKOS_INLINE_FUNCTION bool mayLead(double value, const LeadingPair& all) const {
    return !(value <= square) && !(value < all.value);
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
                          FindFastest<Pair>{pair_of, pairs, is_fast, limit * limit},
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
