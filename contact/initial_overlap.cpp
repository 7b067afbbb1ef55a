#include "contact/initial_overlap.hpp"

#include "contact/base/region.hpp"
#include "contact/candidate_search.hpp"
#include "contact/face_access.hpp"

namespace brickwall::contact {
namespace {

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

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t row, LeadingPair& all) const {
    const int node = pairs.node(row);
    for (std::int64_t pair = pairs.begin(row); pair < pairs.end(row);) {
      const global_id body = faces.body(pairs.faces(pair));
      const LeadingPair one = inBody(node, body, pairs.end(row), pair);
      if (one.value > 0)
        all += one;
    }
  }
  // Moves `pair` past the body's candidates.
  KOKKOS_INLINE_FUNCTION LeadingPair inBody(int node, global_id body, std::int64_t end,
                                            std::int64_t& pair) const {
    const Vec3 x = rowOf(faces.surface.coordinates_new, node);
    double nearest = HUGE_VAL;
    LeadingPair found;
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
      found.value = is_behind ? -point.gap : 0;
      found.pair = {faces.surface.node_ids(node), faces.id(face), faces.surface.node_body(node),
                    body};
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
  LeadingPair local;
  Kokkos::parallel_reduce("contact::deepestOverlap", over(space, search.pairs().num_rows),
                          FindDeepest{FaceAccess{surface, search.ghosts()}, search.pairs()},
                          Combine<LeadingPair>(local));
  space.fence();
  InitialOverlap deepest;
  deepest.depth = allReduce(comm, local.value, MPI_MAX);
  if (deepest.depth > 0)
    static_cast<PairIds&>(deepest) = leaderOfAll(comm, local, deepest.depth);
  return deepest;
}

} // namespace brickwall::contact
