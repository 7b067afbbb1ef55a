// A surface in random order, as a host code may pass it: for `brickwall search`.
#pragma once

#include "io/mesh/mesh_part.hpp"

#include <cstdint>

namespace brickwall::io {

// Not collective. Permutes the local nodes and the local faces by a hash of (seed, global id); the
// surface itself with its ids, coordinates, owners and bodies stays the same. Cost: two sorts.
void shuffleSurface(std::uint64_t seed, SurfacePart& part);

} // namespace brickwall::io
