// Forces of tiles of lattices by teams of threads of a device, with the same bits as those of packs
// (pack_forces.hpp).
#pragma once

#include "mechanics/force/lattice/lattice_tiles.hpp"
#include "mechanics/force/packs/pack_forces.hpp"

namespace brickwall::mechanics {

// Computes the forces of the tiles' elements in the columns internal_force: stores them at nodes of
// one tile, and adds them at the seam nodes, where the columns have to be zero before. Tiles of
// bodies at rest are left out. Not collective.
void addTileForces(const exec_space& space, const LatticeTiles& tiles,
                   const ForceArguments& arguments, LaunchedSums<ForceSums>& sums);

} // namespace brickwall::mechanics
