// The data structure of the cluster search: faces in blocks of eight and nodes in clusters, both
// along a space filling curve. They are kept from step to step; their boxes are refitted in every
// step (phase 1 of the paper).
#pragma once

#include "contact/search/cluster/surface_refit.hpp"
#include "contact/surface/construct_boxes.hpp"

namespace brickwall::contact {

class SurfaceClusters {
public:
  // Phase 1. Orders the surface if it is new (sizes or Views differ from those of the last call) or
  // to be ordered again, then refits all boxes. Not collective. Nodes that are not finite are
  // counted; their faces have no box.
  void update(const exec_space& space, const SweptBoxes& surface, const SearchConfig& config) {
    launchUpdate(space, surface, config);
    readRankBoxes(space);
  }
  // The same in two parts: the boxes are complete for kernels launched after the first, and
  // rankBoxes() after the second, which waits for the device.
  void launchUpdate(const exec_space& space, const SweptBoxes& surface, const SearchConfig& config);
  void readRankBoxes(const exec_space& space);

  // To be called when something of the surface besides its coordinates has changed in place, or
  // when unmanaged Views have been reallocated.
  void orderAgain() { _is_ordered = false; }
  // A search in these clusters has tested so many blocks: orders again, in the next update(), if
  // they have become many.
  void noteSearch(std::int64_t num_blocks);

  const ClusterOrder& order() const { return _order; }
  // [node position][6] FloatBounds sides of every node box, whether the node is owned or not. The
  // View has two floats more.
  const View<float*>& nodeBounds() const { return _same_bounds ? _corner_bounds : _node_bounds; }
  // [cluster][6], owned nodes only; clusters of one node have the bounds of their nodes
  const View<float*>& clusterBounds() const {
    return cluster_size > 1 ? _cluster_bounds : nodeBounds();
  }
  const BoxTree& faceTree() const { return _forest.tree(0); } // items are faces, by position

  // The boxes contain Bbar_n and Bbar_f, tolerances included; they are larger by the rounding to
  // floats.
  const OwnRankBoxes& rankBoxes() const { return _rank_boxes; }
  std::int64_t numOrderings() const { return _num_orderings; }

private:
  bool isNew(const SweptBoxes& surface) const;
  void order(const exec_space& space, const SweptBoxes& surface, const SearchConfig& config);
  void followSurface();

  // Of the last ordering. Keeps managed Views alive, so that surfaces can be told apart by the
  // addresses of their Views.
  SweptBoxes _surface;
  ClusterOrder _order;
  BoxForest _forest;
  // [node position][6] FloatBounds sides of every node's swept point +- face_tolerance, from which
  // the face boxes are made. The View has two floats more.
  View<float*> _corner_bounds{"contact::SurfaceClusters::corner_bounds", 0};
  View<float*> _node_bounds{"contact::SurfaceClusters::node_bounds", 0};
  View<float*> _cluster_bounds{"contact::SurfaceClusters::cluster_bounds", 0};
  RefitScratch _scratch;
  RefitSums _sums;
  OwnRankBoxes _rank_boxes;
  std::int64_t _blocks_when_ordered = 0; // tested by the first search in this order
  std::int64_t _num_orderings = 0;
  bool _is_ordered = false, _same_bounds = true;
};

} // namespace brickwall::contact
