// Host copies of a mesh for set-up code, and host vectors to the device.
#pragma once

#include "mechanics/hex_mesh.hpp"

#include <string>
#include <vector>

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

template <class T>
View<T*> copyToDevice(const exec_space& space, const std::string& label,
                      const std::vector<T>& values) {
  auto view = allocate<View<T*>>(space, label, values.size());
  const auto host = Kokkos::create_mirror_view(view);
  for (std::size_t i = 0; i < values.size(); ++i)
    host(i) = values[i];
  Kokkos::deep_copy(space, view, host);
  space.fence();
  return view;
}

// Rows of W values each.
template <class T, int W>
View<T* [W]> copyRowsToDevice(const exec_space& space, const std::string& label,
                              const std::vector<T>& values) {
  auto view = allocate<View<T* [W]>>(space, label, values.size() / W);
  const auto host = Kokkos::create_mirror_view(view);
  for (std::size_t i = 0; i < values.size() / W; ++i)
    for (int w = 0; w < W; ++w)
      host(i, w) = values[i * W + w];
  Kokkos::deep_copy(space, view, host);
  space.fence();
  return view;
}

} // namespace brickwall::mechanics
