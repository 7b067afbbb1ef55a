// What is asked of edges first, in a cache line each.
#pragma once

#include "contact/surface/face_access.hpp"

namespace brickwall::contact {

// Attributes of an edge as a face of the surface of edges; the masses are those of the corners of the face that lists it.
struct EdgeAttributes : CornerMasses {
  double cosine, sine; // of the angle between the outward normals of its two faces
  std::int64_t goes_on; // FeatureEdge::goes_on
  double width[2]; // FeatureEdge::width, length
};

struct EdgeRecord {
  double end[2][3]; // at x^{n+1} [first or second][xyz], length
  global_id body, id;
};
static_assert(sizeof(EdgeRecord) == 64, "a cache line");

// For kernels.
struct EdgeRecords {
  View<const EdgeRecord*> own, ghosts; // [own edge], [ghost]

  // By candidate index, as FaceAccess.
  KOKKOS_FORCEINLINE_FUNCTION const EdgeRecord& of(int edge) const {
    const int num_own = static_cast<int>(own.extent(0));
    return edge < num_own ? own(edge) : ghosts(edge - num_own);
  }
};

} // namespace brickwall::contact
