// A surface in no useful order, as a host code may hand it over: for `brickwall search`.
#pragma once

#include "io/mesh/mesh_part.hpp"

#include <cstdint>

namespace brickwall::io {

// Not collective. Permutes the local nodes and the local faces by a hash of (seed, global id); corners follow their
// nodes, what ids, coordinates, owners and bodies say stays. Cost: two sorts.
void shuffleSurface(std::uint64_t seed, SurfacePart& part);

} // namespace brickwall::io
