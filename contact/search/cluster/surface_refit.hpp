// The refit of the boxes of a surface: its input, its result and its scratch, for the refits of
// hosts and devices.
#pragma once

#include "contact/search/cluster/cluster_order.hpp"
#include "contact/surface/surface.hpp"

namespace brickwall::contact {

struct RefitInput {
  View<const double*[3]> x_old, x_new;
  View<const global_id*> ids;
  View<const int*> node_order;
  View<const unsigned*> owned;
  View<const int*> corners;
  // [node position][6] and two floats more; node_bounds is not written with same_bounds
  View<float*> corner_bounds, node_bounds;
  View<float*> cluster_bounds; // [cluster][6]
  BoxTree tree; // of the faces
  Vec3 origin;
  double node_tolerance, face_tolerance;
  int num_nodes;
  bool same_bounds;
};

struct RefitSums {
  FloatBounds owned_nodes; // with node_tolerance
  std::int64_t num_invalid = 0;
  global_id first_invalid = INT64_MAX;
  FloatBounds faces;

  KOKKOS_INLINE_FUNCTION RefitSums& operator+=(const RefitSums& b) {
    owned_nodes.include(b.owned_nodes);
    num_invalid += b.num_invalid;
    first_invalid = minOf(first_invalid, b.first_invalid);
    faces.include(b.faces);
    return *this;
  }
};

// Of TeamRefit.
struct RefitScratch {
  View<RefitSums*> node_sums{"contact::SurfaceClusters::node_sums", 0}; // [team]
  View<RefitSums> sums{"contact::SurfaceClusters::sums"};
  Kokkos::View<RefitSums, staging_space> host_sums{"contact::SurfaceClusters::host_sums"};
  std::int64_t num_node_sums = 0;
};

} // namespace brickwall::contact
