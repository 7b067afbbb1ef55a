#include "contact/initial_overlap.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "contact/candidate_search.hpp"
#include "contact/face_access.hpp"

namespace brickwall::contact {
namespace {

struct Deepest {
  double depth = 0;
  global_id node = INT64_MAX, face = INT64_MAX;
  global_id node_body = -1, face_body = -1;

  KOKKOS_INLINE_FUNCTION bool isBefore(const Deepest& b) const {
    if (depth != b.depth)
      return depth > b.depth;
    return node != b.node ? node < b.node : face < b.face;
  }
  KOKKOS_INLINE_FUNCTION Deepest& operator+=(const Deepest& b) {
    if (b.isBefore(*this))
      *this = b;
    return *this;
  }
};

// Squared distance of x from the face's point of parameters kept within the face.
KOKKOS_INLINE_FUNCTION double squaredDistance(const Quad& face, const Vec3& x,
                                              const FacePoint& point) {
  if (!point.has_parameters) // a triangle
    return point.excess <= 0 ? point.gap * point.gap : HUGE_VAL;
  const double xi = maxOf(-1.0, minOf(1.0, point.xi)), eta = maxOf(-1.0, minOf(1.0, point.eta));
  const double weight[4] = {0.25 * (1 - xi) * (1 - eta), 0.25 * (1 + xi) * (1 - eta),
                            0.25 * (1 + xi) * (1 + eta), 0.25 * (1 - xi) * (1 + eta)};
  Vec3 away = x;
  for (int j = 0; j < 4; ++j)
    away -= weight[j] * face.corner[j];
  return dot(away, away);
}

struct FindDeepest {
  static constexpr double on_rim = 1e-9; // where two faces meet, of half-lengths

  FaceAccess faces;
  CandidatePairs pairs;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t row, Deepest& all) const {
    const int node = pairs.node(row);
    for (std::int64_t pair = pairs.begin(row); pair < pairs.end(row);) {
      const global_id body = faces.body(pairs.faces(pair));
      const Deepest one = inBody(node, body, pairs.end(row), pair);
      if (one.depth > 0)
        all += one;
    }
  }
  // Moves `pair` past the body's candidates.
  KOKKOS_INLINE_FUNCTION Deepest inBody(int node, global_id body, std::int64_t end,
                                        std::int64_t& pair) const {
    const Vec3 x = rowOf(faces.surface.coordinates_new, node);
    double nearest = HUGE_VAL;
    Deepest found;
    for (; pair < end && faces.body(pairs.faces(pair)) == body; ++pair) {
      const int face = pairs.faces(pair);
      const Quad quad = faces.quad(face);
      const FacePoint point = project(quad, x);
      if (!point.valid)
        continue;
      const double square = squaredDistance(quad, x, point);
      if (!(square < nearest))
        continue;
      nearest = square;
      const bool is_behind = point.gap < 0 && point.excess <= on_rim;
      found.depth = is_behind ? -point.gap : 0;
      found.node = faces.surface.node_ids(node);
      found.face = faces.id(face);
      found.node_body = faces.surface.node_body(node);
      found.face_body = body;
    }
    return found;
  }
};

} // namespace

InitialOverlap deepestOverlap(const exec_space& space, MPI_Comm comm, const Surface& surface,
                              double reach) {
  const Region region("contact::deepestOverlap");
  SearchConfig config;
  config.node_tolerance = config.face_tolerance = reach;
  config.drop_same_body = true;
  CandidateSearch search(comm, config, 0);
  search.update(space, surface);
  Deepest local;
  Kokkos::parallel_reduce("contact::deepestOverlap", over(space, search.pairs().num_rows),
                          FindDeepest{FaceAccess{surface, search.ghosts()}, search.pairs()},
                          Combine<Deepest>(local));
  space.fence();
  InitialOverlap deepest;
  deepest.depth = allReduce(comm, local.depth, MPI_MAX);
  if (deepest.depth == 0)
    return deepest;
  const auto lowest = [&](bool takes_part, global_id id) {
    return allReduce(comm, takes_part ? id : INT64_MAX, MPI_MIN);
  };
  deepest.node = lowest(local.depth == deepest.depth, local.node);
  const bool has_node = local.depth == deepest.depth && local.node == deepest.node;
  deepest.face = lowest(has_node, local.face);
  const bool has_pair = has_node && local.face == deepest.face;
  deepest.node_body = lowest(has_pair, local.node_body);
  deepest.face_body = lowest(has_pair, local.face_body);
  return deepest;
}

} // namespace brickwall::contact
