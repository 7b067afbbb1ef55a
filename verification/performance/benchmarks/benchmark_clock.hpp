// The clock of the benchmarks.
#pragma once

#include "contact/base/backend.hpp"

#include <chrono>
#include <cstdlib>
#include <ctime>

namespace brickwall {

// Wall-clock time in seconds. With BRICKWALL_CPU_TIME set, the CPU time of the process over its
// threads, which a busy machine disturbs less.
inline double now() {
  static const bool by_cpu = std::getenv("BRICKWALL_CPU_TIME");
  if (!by_cpu)
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC / concurrency(exec_space());
}

} // namespace brickwall
