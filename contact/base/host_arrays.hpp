// Large arrays of the host for set-up. One thread gets new pages of memory at about 2 GB/s, so all
// threads touch them first.
#pragma once

#include "contact/base/backend.hpp"

#include <type_traits>
#include <vector>

namespace brickwall {

// Writes to each page of memory whose contents do not matter.
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

} // namespace brickwall
