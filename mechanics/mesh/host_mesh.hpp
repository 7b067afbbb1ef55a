// Host copies of a mesh for set-up code.
#pragma once

#include "contact/base/to_device.hpp"
#include "mechanics/mesh/hex_mesh.hpp"

#include <memory>
#include <vector>

namespace brickwall::mechanics {

// Host mirrors of the Views of a HexMesh (the same memory on host back ends).
struct HostMesh {
  View<int* [8]>::HostMirror elem_to_nodes;
  View<global_id*>::HostMirror elem_ids;
  View<global_id*>::HostMirror node_ids;
  View<int*>::HostMirror elem_block;
  View<Material*>::HostMirror materials;
  View<double* [3]>::HostMirror reference_coordinates;
};

inline HostMesh copyToHost(const exec_space& space, const HexMesh& mesh) {
  if (!mesh.host) {
    space.fence();
    mesh.host = std::make_shared<const HostMesh>(HostMesh{
        toHost(mesh.elem_to_nodes), toHost(mesh.elem_ids), toHost(mesh.node_ids),
        toHost(mesh.elem_block), toHost(mesh.materials), toHost(mesh.reference_coordinates)});
  }
  return *mesh.host;
}

// [row of HexMesh::bodies] the first row of the same body. The elements of a body with several
// blocks need not be consecutive.
std::vector<int> firstRows(const HexMesh& mesh);

// [node] the first row of its body; the number of rows for a node without elements on this rank.
std::vector<int> bodyOfNodes(const exec_space& space, const HexMesh& mesh,
                             const std::vector<int>& first_rows);

} // namespace brickwall::mechanics
