// Resident memory of this process, and its growth during a piece of work. Host memory only, as the
// kernel counts it.
#pragma once

#include <cstdint>

namespace brickwall::miniapp {

// Present and peak resident memory (the peak since the last MemoryAbove, if there is one), bytes; 0
// where the system does not report it.
std::int64_t residentBytes();
std::int64_t peakResidentBytes();

// Measures the memory that work after its construction needs in addition to that resident at its
// construction. Memory that was freed earlier is first returned to the system and the peak is
// reset, so that a larger set-up does not hide the work.
class MemoryAbove {
public:
  MemoryAbove();

  std::int64_t baselineBytes() const { return _baseline; } // resident at construction
  std::int64_t bytes() const; // peak since construction, above the baseline
  std::int64_t peakBytes() const; // of the whole process, before and since

private:
  std::int64_t _peak_before = 0;
  std::int64_t _baseline = 0;
};

} // namespace brickwall::miniapp
