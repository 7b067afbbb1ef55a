// Node sets of different names that share nodes but have different prescribed motions.
#pragma once

#include "io/mesh/mesh_part.hpp"
#include "miniapp/deck/config.hpp"

#include <mpi.h>

namespace brickwall::miniapp {

// Throws InputError on all ranks if there are such sets. Collective.
void refuseConflictingSets(MPI_Comm comm, const Config& config, const io::MeshPart& part);

} // namespace brickwall::miniapp
