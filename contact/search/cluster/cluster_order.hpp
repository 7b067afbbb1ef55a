// The order in which the cluster search keeps a surface: faces along a Hilbert curve, in blocks of
// eight; nodes in the order in which the faces first use them, in clusters. It is made once and
// kept until it degrades.
#pragma once

#include "contact/search/spatial/box_tree.hpp"
#include "contact/surface/surface.hpp"

namespace brickwall::contact {

// Positions refer to the kept order; nodes and faces are local indices of the host.
struct ClusterOrder {
  int num_clusters = 0; // of nodes: ceil(num_nodes / cluster_size)
  Vec3 origin; // float boxes are relative to it
  View<int*> node_order; // [node position] node
  View<int*> face_order; // [face position] face
  View<int*> corners; // [block][corner][lane] node positions of the faces; -1 in empty lanes
  // [cluster] bit i: the node at position cluster * cluster_size + i is owned here
  View<unsigned*> owned;
  // [face position] rank in the order of (body, face id); empty if the host's faces are in that
  // order
  View<int*> face_rank;
};

// Orders the surface at coordinates_new. Outliers are clipped, so that they do not coarsen the
// curve; coordinates that are not finite are admissible. Needs scratch memory of 24 bytes per face
// and 12 per node during the call.
ClusterOrder orderSurface(const exec_space& space, const SweptBoxes& surface);

// The box of the curve: that of a sample of the points without outliers (points farther away than
// the extent of the middle 31/32 of the sample, in each direction).
Box boxWithoutOutliers(const exec_space& space, const View<const Vec3*>& points, std::int64_t n);

} // namespace brickwall::contact
