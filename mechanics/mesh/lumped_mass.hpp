// Lumped nodal mass: rho V / 8 of each element at its corners, V by 2x2x2 Gauss (exact), summed in fixed point over
// elements and ranks, so the same bits on any number of ranks.
#pragma once

#include "mechanics/mesh/hex_mesh.hpp"
#include "mechanics/mesh/shared_node_sum.hpp"

namespace brickwall::mechanics {

// Mass of every node [node], owned or not. Throws InputError (on all ranks) when an element's volume is not positive,
// naming the element. Collective.
View<double*> lumpedMass(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                         SharedNodeSum& shared);

// Sum over owned nodes of all ranks, exactly rounded. Collective.
double totalMass(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                 const View<const double*>& mass);

} // namespace brickwall::mechanics
