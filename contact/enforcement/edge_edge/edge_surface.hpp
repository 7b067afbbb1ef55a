// The static data of edge-to-edge contact: the convex edges of a surface as rows and candidates of
// contact.
#pragma once

#include "contact/surface/face_access.hpp"
#include "contact/surface/features/feature_edges.hpp"

namespace brickwall::contact {

// Attributes of an edge in its role of a face; the masses are those of the corners of the face that
// lists the edge.
struct EdgeAttributes : CornerMasses {
  double cosine, sine; // of the angle between the outward normals of its two faces
  std::int64_t goes_on; // FeatureEdge::goes_on
  double width[2]; // FeatureEdge::width, length
};

// End points, line (with its body, sideOfBody()) and id of an edge.
struct EdgeRecord {
  double end[2][3]; // at x^{n+1} [first or second][xyz], length
  global_id side, id;
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

struct EdgeSurface {
  // Nodes: the corners of the faces that list edges, then one for each edge. Faces: the edges.
  // Without coordinates.
  SweptBoxes surface;
  int num_corners = 0;
  View<int*> corner_to_node; // [corner] node of the other surface, ascending
  View<int* [4]> edge_to_nodes; // [edge][corner] nodes of the other surface
  View<double*> corner_mass; // [corner]
  View<EdgeRecord*> records; // [edge], without ends
};

EdgeSurface edgeSurface(const exec_space& space, const Surface& surface, const FeatureEdges& edges,
                        const View<const double*>& node_mass);

} // namespace brickwall::contact
