// A named profiling region for the length of a scope. Kokkos Tools see it, and so does the recorder of phase times
// (miniapp/phase_report), which is the only clock in the program.
#pragma once

#include <Kokkos_Core.hpp>

#include <string>

namespace brickwall {

class Region {
public:
  explicit Region(const std::string& name) { Kokkos::Profiling::pushRegion(name); }
  ~Region() { Kokkos::Profiling::popRegion(); }
  Region(const Region&) = delete;
  Region& operator=(const Region&) = delete;
};

} // namespace brickwall
