// Lumped nodal mass: rho V/8 of each element at each of its corners, with V by 2x2x2 Gauss
// quadrature (exact); theory.md, equation (16). Summed in fixed point over elements and ranks, so
// the bits do not depend on the number of ranks.
#pragma once

#include "contact/base/error.hpp"
#include "mechanics/mesh/element_failure.hpp"
#include "mechanics/mesh/hex_mesh.hpp"
#include "mechanics/mesh/shared_node_sum.hpp"

#include <string>

namespace brickwall::mechanics {

// Mass of every node [node], owned or not. Throws BadElementError if an element's volume is not
// positive. Collective.
View<double*> lumpedMass(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                         SharedNodeSum& shared);

// Sum over owned nodes of all ranks, exactly rounded. Collective.
double totalMass(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                 const View<const double*>& mass);

} // namespace brickwall::mechanics
