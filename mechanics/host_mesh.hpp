// Host copies of a mesh for set-up code, and host vectors to the device.
#pragma once

#include "contact/base/to_device.hpp"
#include "mechanics/hex_mesh.hpp"

namespace brickwall::mechanics {

// Host mirrors of the arrays of a HexMesh (the same memory on host back ends).
struct HostMesh {
  View<int* [8]>::HostMirror elem_to_nodes;
  View<global_id*>::HostMirror elem_ids;
  View<global_id*>::HostMirror node_ids;
  View<int*>::HostMirror elem_block;
  View<Material*>::HostMirror materials;
  View<double* [3]>::HostMirror reference_coordinates;
};

inline HostMesh copyToHost(const exec_space& space, const HexMesh& mesh) {
  space.fence();
  const Kokkos::HostSpace host;
  const auto copy = [&](const auto& view) {
    return Kokkos::create_mirror_view_and_copy(host, view);
  };
  return {copy(mesh.elem_to_nodes), copy(mesh.elem_ids),  copy(mesh.node_ids),
          copy(mesh.elem_block),    copy(mesh.materials), copy(mesh.reference_coordinates)};
}

} // namespace brickwall::mechanics
