#include "contact/overlap/initial_overlap.hpp"

#include "contact/base/region.hpp"
#include "contact/overlap/box_pairs.hpp"
#include "contact/overlap/hex_overlap.hpp"
#include "contact/search/candidate_search.hpp"
#include "contact/surface/face_access.hpp"
#include "contact/surface/projection.hpp"

namespace brickwall::contact {
namespace {

// Distance of any point from a face including its rim; projection.hpp gives none where the point
// does not project onto the face.
struct NearestOnFace {
  double square = HUGE_VAL; // of the distance
  // penetration, length; 0: in front of the face, or the nearest point is on the rim
  double depth = 0;
};

// The point of the segment that is nearest to the origin.
KOKKOS_INLINE_FUNCTION Vec3 nearestOnSegment(const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double square = dot(along, along);
  const double t = square > 0 ? minOf(1.0, maxOf(0.0, -dot(a, along) / square)) : 0.0;
  return a + t * along;
}

// Nearest point on the four triangles about the centroid, which share the rim of the quad.
KOKKOS_INLINE_FUNCTION NearestOnFace nearestOnFourTriangles(const Quad& face, const Vec3& point) {
  NearestOnFace nearest;
  const Vec3 outward = areaVector(face);
  const auto take = [&](const Vec3& at, bool is_rim) {
    const double square = dot(at, at);
    if (!(square < nearest.square))
      return;
    nearest.square = square;
    nearest.depth = !is_rim && dot(outward, at) > 0 ? std::sqrt(square) : 0;
  };
  Vec3 q[4];
  for (int j = 0; j < 4; ++j)
    q[j] = face.corner[j] - point;
  const Vec3 centre = 0.25 * ((q[0] + q[1]) + (q[2] + q[3]));
  for (int j = 0; j < 4; ++j) {
    const Vec3 &here = q[j], &next = q[(j + 1) & 3];
    take(nearestOnSegment(here, next), true);
    take(nearestOnSegment(here, centre), false);
    double lambda[3];
    Vec3 normal;
    if (projection::barycentric(here, next, centre, lambda, normal) && lambda[0] > 0 &&
        lambda[1] > 0 && lambda[2] > 0)
      take(dot(here, normal) * normal, false);
  }
  return nearest;
}

KOKKOS_INLINE_FUNCTION NearestOnFace nearestOnFace(const Quad& face, const Vec3& point) {
  constexpr double on_rim = 1e-9; // where two faces meet, in half-lengths
  const FacePoint foot = project(face, point);
  if (!foot.has_parameters || foot.excess > on_rim)
    return nearestOnFourTriangles(face, point);
  return {foot.gap * foot.gap, foot.gap < 0 ? -foot.gap : 0};
}

struct FindDeepest {
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
  // The nearest face of the body; advances `pair` past the candidates of that body.
  KOKKOS_INLINE_FUNCTION LeadingPair inBody(int node, global_id body, std::int64_t end,
                                            std::int64_t& pair) const {
    const Vec3 x = rowOf(faces.surface.coordinates_new, node);
    double least = HUGE_VAL;
    LeadingPair found;
    for (; pair < end && faces.body(pairs.faces(pair)) == body; ++pair) {
      const int face = pairs.faces(pair);
      const NearestOnFace nearest = nearestOnFace(faces.quad(face), x);
      if (!(nearest.square < least))
        continue;
      least = nearest.square;
      found.value = nearest.depth;
      found.pair = {faces.surface.node_ids(node), faces.id(face), faces.surface.node_body(node),
                    body};
    }
    return found;
  }
};

// Node i and face i of the search are the box of element i.
struct FindDeepestElements {
  FaceAccess elements;
  CandidatePairs pairs;
  double least;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t row, LeadingPair& all) const {
    const int own = pairs.node(row);
    const Hexahedron& hex = elements.attributes<Hexahedron>(own);
    const double warp = hexahedron::largestWarp(hex);
    for (std::int64_t pair = pairs.begin(row); pair < pairs.end(row); ++pair) {
      const int face = pairs.faces(pair);
      if (elements.id(face) < elements.id(own)) // the other element's row lists the pair as well
        continue;
      const Hexahedron& other = elements.attributes<Hexahedron>(face);
      const double shallow = least + 0.5 * (warp + hexahedron::largestWarp(other));
      LeadingPair one;
      one.value = overlapDepth(hex, other, shallow);
      one.pair = {elements.id(own), elements.id(face), elements.body(own), elements.body(face)};
      if (one.value > shallow)
        all += one;
    }
  }
};

View<const Box*> boxesOf(const exec_space& space, const BodyElements& elements, double least) {
  const auto boxes =
      allocate<View<Box*>>(space, "contact::deepestElementOverlap::boxes", elements.count);
  const auto hexahedra = elements.hexahedra;
  Kokkos::parallel_for(
      "contact::deepestElementOverlap::boxes", rangePolicy(space, elements.count),
      KOKKOS_LAMBDA(const std::int64_t element) {
        Box box;
        for (int i = 0; i < 8; ++i)
          box.include(hexahedra(element).corner[i]);
        boxes(element) = shrunk(box, least);
      });
  return boxes;
}

// The data that the search sends along with an element.
AttributeWords attributesOf(const exec_space& space, const BodyElements& elements) {
  auto words = allocateAttributes<Hexahedron>(space, "contact::deepestElementOverlap::hexahedra",
                                              elements.count);
  const auto hexahedra = elements.hexahedra;
  Kokkos::parallel_for(
      "contact::deepestElementOverlap::attributes", rangePolicy(space, elements.count),
      KOKKOS_LAMBDA(const std::int64_t element) {
        attributesAt<Hexahedron>(words, element) = hexahedra(element);
      });
  return words;
}

// The centre of the element of this id, which one rank has.
Vec3 centreOf(const exec_space& space, MPI_Comm comm, const BodyElements& elements, global_id id) {
  const auto hexahedra = elements.hexahedra;
  const auto ids = elements.ids;
  double centre[3];
  for (int d = 0; d < 3; ++d) {
    centre[d] = -HUGE_VAL;
    Kokkos::parallel_reduce(
        "contact::deepestElementOverlap::centre", rangePolicy(space, elements.count),
        KOKKOS_LAMBDA(const std::int64_t element, double& all) {
          if (ids(element) != id)
            return;
          all = 0;
          for (int i = 0; i < 8; ++i)
            all += 0.125 * hexahedra(element).corner[i][d];
        },
        Kokkos::Max<double>(centre[d]));
  }
  allReduce(comm, centre, 3, MPI_MAX);
  return {centre[0], centre[1], centre[2]};
}

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
  Kokkos::parallel_reduce("contact::deepestOverlap", rangePolicy(space, search.pairs().num_rows),
                          FindDeepest{FaceAccess{surface, search.ghosts()}, search.pairs()},
                          PlusReducer<LeadingPair>(local));
  const LeadingPair leader = leaderOfAll(comm, local);
  return {leader.pair, leader.value};
}

ElementOverlap deepestElementOverlap(const exec_space& space, MPI_Comm comm,
                                     const BodyElements& elements, double least) {
  const Region region("contact::deepestElementOverlap");
  ElementOverlap deepest;
  if (allReduce(comm, elements.count, MPI_MAX) == 0)
    return deepest;
  const SweptBoxes surface = sweptBoxes(space, boxesOf(space, elements, least), elements.ids,
                                        elements.bodies, attributesOf(space, elements));
  SearchConfig config;
  config.drop_same_body = true;
  CandidateSearch search(comm, config);
  search.update(space, surface);
  LeadingPair local;
  Kokkos::parallel_reduce(
      "contact::deepestElementOverlap", rangePolicy(space, search.pairs().num_rows),
      FindDeepestElements{FaceAccess{surface, search.ghosts()}, search.pairs(), least},
      PlusReducer<LeadingPair>(local));
  const LeadingPair leader = leaderOfAll(comm, local);
  deepest.depth = leader.value;
  if (deepest.depth > 0) {
    const PairIds& pair = leader.pair;
    deepest.element = pair.node;
    deepest.other = pair.face;
    deepest.body = pair.node_body;
    deepest.other_body = pair.face_body;
    deepest.centre = centreOf(space, comm, elements, deepest.element);
  }
  return deepest;
}

} // namespace brickwall::contact
