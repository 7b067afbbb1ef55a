// The surface as the cluster search sees it: faces in blocks of eight and nodes in clusters of sixteen, both along a space
// filling curve, that are kept from step to step; their boxes are refitted in every step (phase 1 of the paper).
#pragma once

#include "contact/box_tree.hpp"
#include "contact/search_config.hpp"
#include "contact/surface.hpp"

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
  // [face] place in the order of (body, face id); empty if that is the order of the host's faces
  View<int*> face_rank;
};

class SurfaceClusters {
public:
  // Phase 1. Orders the surface if it is new (other sizes or Views than at the last call) or if the order was asked to be
  // made again, then refits. Not collective. Coordinates that are not finite are counted and take no part.
  void update(const exec_space& space, const Surface& surface, const SearchConfig& config);
  // Something of the surface besides its coordinates has changed in place, or the order has worn out.
  void orderAgain() { _is_ordered = false; }

  const ClusterOrder& order() const { return _order; }
  // [node position][6] float sides of node boxes, as of the face boxes' corners: swept point +- face_tolerance. Node
  // boxes proper are those of queryBounds(); the same View where both tolerances are equal.
  const View<float*>& cornerBounds() const { return _corner_bounds; }
  const View<float*>& queryBounds() const { return _same_bounds ? _corner_bounds : _query_bounds; }
  const View<float*>& clusterBounds() const {
    return _cluster_bounds;
  } // [cluster][6], owned nodes only
  const BoxTree& faceTree() const {
    return _forest.tree(0);
  } // leaves in the order of face positions

  const Box& nodeBox() const { return _node_box; } // Bbar_n, node_tolerance included
  const Box& faceBox() const { return _face_box; } // Bbar_f, face_tolerance included
  std::int64_t numInvalid() const { return _num_invalid; } // nodes that are not finite
  global_id firstInvalid() const { return _first_invalid; }
  std::int64_t numOrderings() const { return _num_orderings; }

private:
  bool isNew(const Surface& surface) const;

  Surface
      _surface; // of the last ordering: keeps its Views alive, so that their addresses tell surfaces apart
  ClusterOrder _order;
  BoxForest _forest;
  View<float*> _corner_bounds{"contact::SurfaceClusters::corner_bounds", 0};
  View<float*> _query_bounds{"contact::SurfaceClusters::query_bounds", 0};
  View<float*> _cluster_bounds{"contact::SurfaceClusters::cluster_bounds", 0};
  Box _node_box, _face_box;
  std::int64_t _num_invalid = 0, _num_orderings = 0;
  global_id _first_invalid = 0;
  bool _is_ordered = false, _same_bounds = true;
};

} // namespace brickwall::contact
