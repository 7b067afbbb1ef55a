// Copies of host arrays as device Views and back, for set-up.
#pragma once

#include "contact/base/backend.hpp"

#include <string>
#include <vector>

namespace brickwall {

// A device copy of `values`, entry by entry: rank-1 Views, or [n][W] from rows stored one after
// another.
template <class ViewType, class T>
ViewType toDevice(const exec_space& space, const std::string& label, const std::vector<T>& values) {
  constexpr std::size_t rank = ViewType::rank;
  static_assert(rank == 1 || rank == 2);
  ViewType shape; // its static second extent, if any
  const std::size_t width = rank == 1 ? 1 : shape.extent(1);
  const std::size_t n = values.size() / width;
  auto device = allocate<ViewType>(space, label, n);
  auto host = Kokkos::create_mirror_view(device);
  for (std::size_t i = 0; i < n; ++i) {
    if constexpr (rank == 1)
      host(i) = values[i];
    else
      for (std::size_t w = 0; w < width; ++w)
        host(i, w) = values[i * width + w];
  }
  Kokkos::deep_copy(space, device, host);
  space.fence();
  return device;
}
template <class T>
View<T*> toDevice(const exec_space& space, const std::string& label, const std::vector<T>& values) {
  return toDevice<View<T*>>(space, label, values);
}

// A View that the host can read; `view` itself where it is host-accessible. Fences.
template <class ViewType>
auto toHost(const ViewType& view) {
  return Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), view);
}

} // namespace brickwall
