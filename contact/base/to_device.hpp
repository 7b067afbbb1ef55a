// Host arrays for set-up, copies of them as device Views and back.
#pragma once

#include "contact/base/backend.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace brickwall {

// Writes to each page of memory whose contents do not matter: one thread gets new pages at about
// 2 GB/s, so all threads of the host touch them.
inline void touchPages(void* memory, std::size_t num_bytes) {
  constexpr std::size_t page = 4096, large = std::size_t(1) << 20;
  if (num_bytes < large || host_exec_space().concurrency() == 1)
    return;
  char* const bytes = static_cast<char*>(memory);
  parallelOnHost("base::touchPages", static_cast<std::int64_t>(num_bytes / page),
                 [bytes](const std::int64_t i) { bytes[i * page] = 0; });
}

// A vector of n values T().
template <class T>
std::vector<T> hostArray(std::int64_t n) {
  static_assert(std::is_trivially_copyable<T>::value);
  std::vector<T> values;
  values.reserve(static_cast<std::size_t>(n));
  touchPages(values.data(), sizeof(T) * values.capacity());
  values.resize(static_cast<std::size_t>(n));
  return values;
}

// A host View for the values of `view`, not initialised; `view` itself where it is host-accessible.
template <class ViewType>
auto hostMirror(const ViewType& view) {
  if constexpr (std::is_same<typename ViewType::memory_space, Kokkos::HostSpace>::value) {
    return view;
  } else {
    typename ViewType::HostMirror host(
        Kokkos::view_alloc(Kokkos::WithoutInitializing, view.label()), view.layout());
    touchPages(host.data(), sizeof(typename ViewType::value_type) * host.span());
    return host;
  }
}

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
  const auto host = hostMirror(device);
  parallelOnHost("base::toDevice", static_cast<std::int64_t>(n), [&](const std::int64_t i) {
    if constexpr (rank == 1)
      host(i) = values[i];
    else
      for (std::size_t w = 0; w < width; ++w)
        host(i, w) = values[i * width + w];
  });
  Kokkos::deep_copy(space, device, host);
  space.fence();
  return device;
}
template <class T>
View<T*> toDevice(const exec_space& space, const std::string& label, const std::vector<T>& values) {
  return toDevice<View<T*>>(space, label, values);
}

// Stores values that travel as arguments of the kernel.
template <class T>
struct StoreArguments {
  static constexpr std::size_t capacity = 2048 / sizeof(T) > 0 ? 2048 / sizeof(T) : 1;

  T values[capacity];
  View<T*> to;
  std::int64_t first;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t i) const { to(first + i) = values[i]; }
};

// Copies a host vector to the first entries of a device View, which is grown where needed. A device
// gets few values without a wait of the host.
template <class T>
void copyToDevice(const exec_space& space, const std::vector<T>& from, View<T*>& to) {
  growTo(space, to, static_cast<std::int64_t>(from.size()));
  if (from.empty())
    return;
  using Store = StoreArguments<T>;
  if (!host_accessible && from.size() <= 4 * Store::capacity) {
    for (std::size_t first = 0; first < from.size(); first += Store::capacity) {
      const std::size_t count = std::min(Store::capacity, from.size() - first);
      Store store{{}, to, static_cast<std::int64_t>(first)};
      std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(first), count, store.values);
      Kokkos::parallel_for("base::copyToDevice",
                           rangePolicy(space, static_cast<std::int64_t>(count)), store);
    }
    return;
  }
  Kokkos::deep_copy(
      space, Kokkos::subview(to, std::make_pair(std::size_t(0), from.size())),
      Kokkos::View<const T*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged>(from.data(), from.size()));
  space.fence();
}

// A View that the host can read; `view` itself where it is host-accessible. Fences.
template <class ViewType>
auto toHost(const ViewType& view) {
  auto host = hostMirror(view);
  if constexpr (std::is_same<typename ViewType::memory_space, Kokkos::HostSpace>::value)
    Kokkos::fence();
  else
    Kokkos::deep_copy(host, view);
  return host;
}

} // namespace brickwall
