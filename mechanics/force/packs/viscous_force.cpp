#include "mechanics/force/packs/viscous_force.hpp"

namespace brickwall::mechanics {

ForceSums addWithViscosity(const exec_space& space, ElementKind kind, const ChunkGroup& group,
                           const ForceArguments& arguments) {
  return launchForces<true>(space, kind, group, arguments);
}

} // namespace brickwall::mechanics
