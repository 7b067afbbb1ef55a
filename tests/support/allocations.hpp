// The Views that a piece of work allocates.
#pragma once

#include <Kokkos_Core.hpp>

#include <mutex>
#include <string>
#include <vector>

namespace brickwall::testing {

// Labels of the Views allocated by work(), but for scratch memory that Kokkos adds to its pools.
template <class Work>
std::vector<std::string> allocationsOf(const Work& work) {
  static std::vector<std::string> labels;
  static std::mutex mutex;
  labels.clear();
  Kokkos::Tools::Experimental::set_allocate_data_callback(
      [](Kokkos_Profiling_SpaceHandle, const char* label, const void*, std::uint64_t) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (std::string(label).rfind("Kokkos::", 0) != 0)
          labels.emplace_back(label);
      });
  work();
  Kokkos::Tools::Experimental::set_allocate_data_callback(nullptr);
  return labels;
}

const std::vector<std::string> no_allocations;

} // namespace brickwall::testing
