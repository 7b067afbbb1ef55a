// The order in which the cluster search keeps a surface: faces along a Hilbert curve, in blocks of
// eight, body by body if pairs within a body are dropped; nodes in the order in which the faces
// first use them, in clusters. It is made once and kept until it degrades.
#pragma once

#include "contact/search/spatial/box_tree.hpp"
#include "contact/surface/surface.hpp"

namespace brickwall::contact {

constexpr global_id many_bodies = INT64_MIN; // no id of a body

// Positions refer to the kept order; nodes and faces are local indices of the host.
struct ClusterOrder {
  int num_clusters = 0; // of nodes: ceil(num_nodes / cluster_size)
  Vec3 origin; // float boxes are relative to it
  View<int*> node_order; // [node position] node
  View<int*> face_order; // [face position] face
  View<int*> corners; // [block][corner][lane] node positions of the faces; -1 in empty lanes
  // [cluster] bit i: the node at position cluster * cluster_size + i is owned here
  View<unsigned*> owned;
  // [face position] rank in the order of (side, face id); empty if the host's faces are in that
  // order
  View<int*> face_rank;
  // Of orders by body, otherwise empty: the body to which all nodes of a cluster belong, or all
  // faces of a block and all their corners; many_bodies if there is none.
  View<global_id*> cluster_body, block_body;

  KOKKOS_INLINE_FUNCTION global_id bodyOfCluster(std::int64_t cluster) const {
    return cluster_body.extent(0) > 0 ? cluster_body(cluster) : many_bodies;
  }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchCorners(std::int64_t block) const {
    constexpr int words = 4 * block_size, words_of_line = 16;
    for (int i = 0; i < words; i += words_of_line)
      prefetch(&corners(block * words + i));
  }
};

// Orders the surface at coordinates_new. Outliers are clipped, so that they do not coarsen the
// curve; coordinates that are not finite are admissible. With by_body the bodies follow each other
// as their first faces do along the curve. Needs scratch memory of 24 bytes per face and 12 per
// node during the call.
ClusterOrder orderSurface(const exec_space& space, const SweptBoxes& surface, bool by_body);

// The box of the curve: that of a sample of the points without outliers (points farther away than
// the extent of the middle 31/32 of the sample, in each direction).
Box boxWithoutOutliers(const exec_space& space, const View<const Vec3*>& points, std::int64_t n);

} // namespace brickwall::contact
