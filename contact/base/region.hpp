// A named profiling region for the length of a scope. Kokkos Tools see it, and so does the recorder
// of phase times (miniapp/timing), which is the only clock in the program.
#pragma once

#include <Kokkos_Core.hpp>

#include <string>

namespace brickwall {

// The region of waits for other ranks: for messages and reductions.
constexpr const char* waiting_region = "base::waitForRanks";

class Region {
public:
  explicit Region(const char* name) {
    // Kokkos takes a string and reads it immediately; a persistent one allocates nothing after the
    // first steps.
    thread_local std::string text;
    text = name;
    Kokkos::Profiling::pushRegion(text);
  }
  ~Region() { Kokkos::Profiling::popRegion(); }
  Region(const Region&) = delete;
  Region& operator=(const Region&) = delete;
};

} // namespace brickwall
