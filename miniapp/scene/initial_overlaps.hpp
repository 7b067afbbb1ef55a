// Refuses scenes whose bodies stand in each other at the start deeper than contact sees.
#pragma once

#include "contact/surface/surface.hpp"
#include "miniapp/scene/scene.hpp"

namespace brickwall::miniapp {

// Contact would not see them, and let the bodies pass through each other. `surface` is at X + `displacement`. Throws InputError on
// all ranks, naming the bodies and how deep and where they overlap. Collective.
void refuseDeepOverlaps(const exec_space& space, MPI_Comm comm, const Config& config,
                        const Scene& scene, const contact::Surface& surface,
                        const View<const double* [3]>& displacement);

} // namespace brickwall::miniapp
