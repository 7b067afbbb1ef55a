// The surface as the cluster search sees it: faces in blocks of eight and nodes in clusters, both along a space filling
// curve, that are kept from step to step; their boxes are refitted in every step (phase 1 of the paper).
#pragma once

#include "contact/search/cluster/cluster_order.hpp"
#include "contact/surface/search_config.hpp"

namespace brickwall::contact {

class SurfaceClusters {
public:
  // Phase 1. Orders the surface if it is new (other sizes or Views than at the last call) or if its order has worn out,
  // then refits all boxes. Not collective. Nodes that are not finite are counted; their faces have no box.
  void update(const exec_space& space, const Surface& surface, const SearchConfig& config);

  // Something of the surface besides its coordinates has changed in place, or unmanaged Views have been allocated again.
  void orderAgain() { _is_ordered = false; }

  const ClusterOrder& order() const { return _order; }
  // [node position][6] FloatBounds sides of every node's swept point +- face_tolerance: what face boxes are made of. The
  // View has two floats more.
  const View<float*>& cornerBounds() const { return _corner_bounds; }
  // The same with node_tolerance: node boxes, owned or not.
  const View<float*>& nodeBounds() const { return _same_bounds ? _corner_bounds : _node_bounds; }
  const View<float*>& clusterBounds() const {
    return _cluster_bounds;
  } // [cluster][6], owned nodes only
  const BoxTree& faceTree() const { return _forest.tree(0); } // items are faces, by position

  // Boxes that hold Bbar_n and Bbar_f, tolerances included: a rounding of a float larger.
  const Box& nodeBox() const { return _node_box; }
  const Box& faceBox() const { return _face_box; }
  std::int64_t numInvalid() const { return _sums.num_invalid; } // nodes that are not finite
  global_id firstInvalid() const { return _sums.first_invalid; } // smallest global id of those
  std::int64_t numOrderings() const { return _num_orderings; }

  // What is reduced over the nodes in every step. Public for the kernels only.
  struct Sums {
    FloatBounds owned_nodes; // with node_tolerance
    std::int64_t num_invalid = 0;
    global_id first_invalid = INT64_MAX;

    KOKKOS_INLINE_FUNCTION Sums& operator+=(const Sums& b) {
      owned_nodes.include(b.owned_nodes);
      num_invalid += b.num_invalid;
      first_invalid = minOf(first_invalid, b.first_invalid);
      return *this;
    }
  };

private:
  bool isNew(const Surface& surface) const;
  void order(const exec_space& space, const Surface& surface, const SearchConfig& config);
  void followSurface();

  Surface
      _surface; // of the last ordering: keeps managed Views alive, so that their addresses tell surfaces apart
  ClusterOrder _order;
  BoxForest _forest;
  View<float*> _corner_bounds{"contact::SurfaceClusters::corner_bounds", 0};
  View<float*> _node_bounds{"contact::SurfaceClusters::node_bounds", 0};
  View<float*> _cluster_bounds{"contact::SurfaceClusters::cluster_bounds", 0};
  Sums _sums;
  Box _node_box, _face_box;
  // Summed extents of the blocks of faces, length; one block counts at most _most_extent.
  double _extent = 0, _extent_when_ordered = 0, _most_extent = 0;
  std::int64_t _num_orderings = 0;
  bool _is_ordered = false, _same_bounds = true;
};

} // namespace brickwall::contact
