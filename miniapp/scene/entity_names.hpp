// Names of nodes, edges, faces, elements and bodies in messages.
#pragma once

#include "contact/base/backend.hpp"
#include "io/mesh/mesh_part.hpp"
#include "miniapp/deck/config.hpp"

#include <mpi.h>

#include <string>

namespace brickwall::miniapp {

std::string nodeName(global_id node);
std::string elementName(global_id element);
// Faces of the skin are numbered 6 * element + side (mechanics/mesh/skin.hpp).
std::string faceName(global_id face);
// Edges are numbered 4 * face + corner.
std::string edgeName(global_id edge);

// A brick of a wall is also named by its course, wythe and place, as in the deck.
std::string bodyName(const Config& config, global_id body);

// A body of a mesh is also named by the element block of its first element. Collective.
std::string bodyName(MPI_Comm comm, const Config& config, const io::MeshPart& part, global_id body);

} // namespace brickwall::miniapp
