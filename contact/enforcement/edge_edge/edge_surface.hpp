// The surface whose faces and pushing points are the convex edges of another one: what of it stays as it is.
#pragma once

#include "contact/enforcement/edge_edge/edge_records.hpp"
#include "contact/surface/feature_edges.hpp"

namespace brickwall::contact {

struct EdgeSurface {
  // Nodes: the corners of the faces that list edges, then one for each edge. Faces: the edges. Without coordinates.
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
