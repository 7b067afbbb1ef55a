// Forces of lattices of elements, plane by plane, with the same bits as those of packs
// (pack_forces.hpp).
#pragma once

#include "mechanics/force/packs/pack_forces.hpp"

namespace brickwall::mechanics {

// Numbers of scratch memory per thread for sweeps over these lattices; 0 without lattices, as on
// devices.
std::int64_t latticeScratch(const std::vector<BrickLattice>& lattices);

// Adds the forces of the slabs' elements to the columns internal_force. Nothing else may add to
// their nodes at the same time. Not collective; fences.
ForceSums addLatticeForces(const exec_space& space, const LatticeTables& tables,
                           const View<LatticeSlab*>& slabs, const ForceArguments& arguments);

} // namespace brickwall::mechanics
