// The element kernels with bulk viscosity, compiled apart: runs without it launch those of internal_force.cpp, which know
// nothing of it. Included by the kernels of InternalForce only.
#pragma once

#include "mechanics/force/packs/internal_force_kernel.hpp"

namespace brickwall::mechanics {

// One group of chunks: elastic and viscous forces. Not collective; fences.
ForceSums addWithViscosity(const exec_space& space, ElementKind kind, const ChunkGroup& group,
                           const ForceArguments& arguments);

} // namespace brickwall::mechanics
