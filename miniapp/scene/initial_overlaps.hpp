// Refuses scenes whose bodies overlap at the start more deeply than contact can resolve.
#pragma once

#include "contact/surface/surface.hpp"
#include "miniapp/scene/scene.hpp"

namespace brickwall::miniapp {

// Contact would not detect such overlaps, and the bodies would pass through each other. `surface`
// is at X + `displacement`. Throws InputError on all ranks, naming the bodies, depth and place of
// the overlap. Collective.
void refuseDeepOverlaps(const exec_space& space, MPI_Comm comm, const Config& config,
                        const Scene& scene, const contact::Surface& surface,
                        const View<const double* [3]>& displacement);

} // namespace brickwall::miniapp
