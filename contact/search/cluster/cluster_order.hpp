// The order that the cluster search keeps a surface in: faces along a Hilbert curve, in blocks of eight; nodes in the order
// in which the faces first use them, in clusters. Made once and kept while it serves.
#pragma once

#include "contact/search/spatial/box_tree.hpp"
#include "contact/surface/surface.hpp"

namespace brickwall::contact {

// Positions are places in the kept order; nodes and faces are the host's local indices.
struct ClusterOrder {
  int num_clusters = 0; // of nodes: ceil(num_nodes / cluster_size)
  Vec3 origin; // float boxes are relative to it
  View<int*> node_order; // [node position] node
  View<int*> face_order; // [face position] face
  View<int*> corners; // [block][corner][lane] node positions of the faces; -1 in empty lanes
  View<unsigned*>
      owned; // [cluster] bit i: node at position cluster * cluster_size + i is owned here
  // [face position] place in the order of (body, face id); empty if that is the order of the host's faces
  View<int*> face_rank;
};

// Orders the surface at coordinates_new. Points far from all others are clipped, so that they do not coarsen the curve;
// coordinates that are not finite do no harm. Scratch of 24 bytes a face and 12 a node lives during the call only.
ClusterOrder orderSurface(const exec_space& space, const SweptBoxes& surface);

// The box that the curve is laid through: that of a sample of the points, without outliers (points further off than the
// extent of the middle 31/32 of the sample, in each direction).
Box boxWithoutOutliers(const exec_space& space, const View<const Vec3*>& points, std::int64_t n);

} // namespace brickwall::contact
