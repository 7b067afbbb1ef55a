// Bodies of a mesh: elements connected through shared nodes, over all ranks.
#pragma once

#include "io/mesh/mesh_part.hpp"

#include <mpi.h>

namespace brickwall::io {

// Sets elem_body and num_global_bodies of `part` from its connectivity and shared_nodes. Bodies are
// numbered from 0 in the order of their lowest element id, so the numbers do not depend on the
// partition. Collective; the number of exchanges is the number of rank boundaries on the longest
// path through a body.
void findBodies(MPI_Comm comm, MeshPart& part);

} // namespace brickwall::io
