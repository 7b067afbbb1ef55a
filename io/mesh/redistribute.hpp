// The mesh on other ranks: elements move with their nodes and their entries in sets.
#pragma once

#include "io/mesh/mesh_part.hpp"

#include <mpi.h>

#include <vector>

namespace brickwall::io {

// This rank's part of the mesh of which all ranks give their parts, when each element of `part`
// goes to the rank rank_of_elem[elem]: the part that a reader or generator with these ranks makes,
// whatever the ranks were before. Ranks may get no element. No rank holds more than its two parts.
// Collective. Throws Error on all ranks when a part outgrows 32-bit local indices.
MeshPart redistribute(MPI_Comm comm, const MeshPart& part, const std::vector<int>& rank_of_elem);

} // namespace brickwall::io
