// Boundary conditions of a deck that contradict each other.
#pragma once

#include "io/deck/deck.hpp"
#include "io/mesh/mesh_part.hpp"
#include "miniapp/deck/config.hpp"

#include <mpi.h>

namespace brickwall::miniapp {

// Adds a fault for each [[boundary.fixed]] and [[boundary.velocity]] of `config` that moves a component of a node set otherwise than one
// before it, naming both places.
void complainOfConflicts(const Config& config, io::Deck& deck);

// The same of node sets of different names that share nodes of this mesh. Collective; throws InputError on all ranks.
void refuseConflictsOfSets(MPI_Comm comm, const Config& config, const io::MeshPart& part);

} // namespace brickwall::miniapp
