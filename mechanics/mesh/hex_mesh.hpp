// One rank's part of a hexahedral mesh on the device, with materials per block.
#pragma once

#include "contact/base/backend.hpp"
#include "mechanics/element/material.hpp"

#include <mpi.h>

#include <memory>
#include <vector>

namespace brickwall::mechanics {

// Elements [first, first + count) of one body on this rank. Bodies share no nodes.
struct ElementRange {
  int first = 0, count = 0;
  global_id body = -1; // number of the body, the same on every rank that holds a part of it
};

struct HostMesh; // host_mesh.hpp

struct HexMesh {
  int num_nodes = 0;
  int num_elems = 0;
  View<int* [8]> elem_to_nodes; // [elem][corner], Exodus corner order
  View<global_id*> elem_ids; // [elem] 0-based
  View<global_id*> node_ids; // [node] 0-based
  View<unsigned char*> node_is_owned; // [node] each node is owned by exactly one rank
  View<int*> elem_block; // [elem] index into materials
  View<Material*> materials; // [block]
  View<double* [3]> reference_coordinates; // X [node][xyz], length
  std::vector<ElementRange> bodies; // this rank's part of each body, consecutive elements
  // Kept by copyToHost(), after which the Views do not change, for later calls until it is reset.
  mutable std::shared_ptr<const HostMesh> host;
};

// The Views of a mesh that kernels capture, without host containers.
struct MeshViews {
  View<const int* [8]> elem_to_nodes;
  View<const global_id*> elem_ids;
  View<const unsigned char*> node_is_owned;
  View<const int*> elem_block;
  View<const Material*> materials;
  View<const double* [3]> reference_coordinates;
};
inline MeshViews viewsOf(const HexMesh& mesh) {
  return {mesh.elem_to_nodes, mesh.elem_ids,  mesh.node_is_owned,
          mesh.elem_block,    mesh.materials, mesh.reference_coordinates};
}

// Neighbour ranks and the local nodes shared with each, in the same order on both sides; for
// SharedNodeSum.
struct SharedNodeLists {
  std::vector<int> ranks;
  std::vector<std::vector<int>> nodes;
};

} // namespace brickwall::mechanics
