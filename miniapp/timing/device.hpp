// The GPU that this rank uses. Its source is the only one of miniapp/ that names a back end.
#pragma once

#include <cstdint>
#include <string>

namespace brickwall::miniapp {

struct Device {
  std::string name = "none"; // without a GPU, all else is empty
  std::string versions; // of the runtime library and of the driver
  std::int64_t bytes = 0; // of its memory
  std::int64_t bytes_in_use = 0; // by all processes and their contexts, now
};
// Needs Kokkos to be initialised.
Device describeDevice();

} // namespace brickwall::miniapp
