// The Views that a piece of work allocates.
#pragma once

#include <Kokkos_Core.hpp>

#include <atomic>

namespace brickwall::testing {

// Number of Views allocated by work().
template <class Work>
int allocationsOf(const Work& work) {
  static std::atomic<int> count;
  count = 0;
  Kokkos::Tools::Experimental::set_allocate_data_callback(
      [](Kokkos_Profiling_SpaceHandle, const char*, const void*, std::uint64_t) { ++count; });
  work();
  Kokkos::Tools::Experimental::set_allocate_data_callback(nullptr);
  return count;
}

} // namespace brickwall::testing
