// The memory that a run takes, estimated from the size of its scene; `brickwall check` prints it.
#pragma once

#include <cstdint>

namespace brickwall::miniapp {

struct SceneSize {
  std::int64_t elements = 0, nodes = 0;
  std::int64_t faces = 0, edges = 0; // of the surface, and of these the feature edges
  bool stores_geometry = false; // for each element
  bool has_contact = true;
};

struct MemoryEstimate {
  double of_device = 0; // bytes of one rank: Views of the time loop, and the context of a GPU
  double of_rank = 0; // all bytes of one rank, on host and device
};

// The largest memory of a run with output on ranks of equal size, in which contacts are under load
// on three quarters of the faces. `on_gpu`: its Views lie in a memory of their own.
MemoryEstimate estimateMemory(const SceneSize& size, int ranks, bool on_gpu);

} // namespace brickwall::miniapp
