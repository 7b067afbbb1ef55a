// Forces of lattices of elements, plane by plane, in place of packs (pack_forces.hpp): the same bits.
#pragma once

#include "mechanics/force/packs/pack_forces.hpp"

namespace brickwall::mechanics {

// Numbers of scratch memory that a thread needs for sweeps over these; 0 where there are none, as on devices.
std::int64_t latticeScratch(const std::vector<BrickLattice>& lattices);

// Adds the forces of the slabs' elements to the columns internal_force. Nothing else may add to their nodes meanwhile. Not
// collective; fences.
ForceSums addLatticeForces(const exec_space& space, const LatticeTables& tables,
                           const View<LatticeSlab*>& slabs, const ForceArguments& arguments);

} // namespace brickwall::mechanics
