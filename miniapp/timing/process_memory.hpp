// Resident memory of this process, and how far a stretch of work raised it. Host memory only, as the kernel counts it.
#pragma once

#include <cstdint>

namespace brickwall::miniapp {

// Resident now, and the most so far (since the last MemoryAbove, if one was made); bytes, 0 where the system does not say.
std::int64_t residentBytes();
std::int64_t peakResidentBytes();

// Measures what the work after its construction needs above what is resident then. Memory that was freed before is
// given back to the system first and the peak starts anew, so that a set-up that needed more does not hide the work.
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
