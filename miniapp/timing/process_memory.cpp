#include "miniapp/timing/process_memory.hpp"

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <string>
#include <sys/resource.h>

// Part of the GNU C library; null with other libraries, where freed memory then counts as in use.
extern "C" int malloc_trim(std::size_t) noexcept __attribute__((weak));

namespace brickwall::miniapp {
namespace {

// A line "name:   123 kB" of /proc/self/status, in bytes; 0 if there is none.
std::int64_t statusBytes(const std::string& name) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);)
    if (line.compare(0, name.size() + 1, name + ":") == 0)
      return 1024 * std::stoll(line.substr(name.size() + 1));
  return 0;
}

// Linux: writing 5 to clear_refs sets the peak to the present resident size. Where that is refused,
// the earlier peak stays.
void restartPeak() {
  std::ofstream("/proc/self/clear_refs") << 5;
}

} // namespace

std::int64_t residentBytes() {
  return statusBytes("VmRSS");
}

std::int64_t peakResidentBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const std::int64_t since_start = 1024 * static_cast<std::int64_t>(usage.ru_maxrss);
  return std::max(since_start, statusBytes("VmHWM"));
}

MemoryAbove::MemoryAbove() : _peak_before(peakResidentBytes()) {
  if (malloc_trim)
    malloc_trim(0);
  _baseline = residentBytes();
  restartPeak();
}

std::int64_t MemoryAbove::bytes() const {
  return std::max<std::int64_t>(statusBytes("VmHWM") - _baseline, 0);
}

std::int64_t MemoryAbove::peakBytes() const {
  return std::max(_peak_before, peakResidentBytes());
}

} // namespace brickwall::miniapp
