// How messages name a body.
#pragma once

#include "miniapp/deck/config.hpp"

#include "io/mesh/mesh_part.hpp"

#include <mpi.h>

#include <string>

namespace brickwall::miniapp {

// Bricks of a wall also as a deck's `brick` names them.
std::string bodyName(const Config& config, global_id body);

// Also bodies of a mesh by the element block of their first element. Collective.
std::string bodyName(MPI_Comm comm, const Config& config, const io::MeshPart& part, global_id body);

} // namespace brickwall::miniapp
