// Names of nodes, edges, faces, elements and bodies in messages. Nodes and elements are named by
// their global id and by the id that other programs know.
#pragma once

#include "contact/base/backend.hpp"
#include "io/mesh/mesh_part.hpp"
#include "miniapp/deck/config.hpp"

#include <mpi.h>

#include <string>

namespace brickwall::miniapp {

// All functions are collective.
class EntityNames {
public:
  EntityNames(MPI_Comm comm, const io::MeshPart& part) : _comm(comm), _part(part) {}
  std::string node(global_id node) const;
  std::string element(global_id element) const;
  // Faces of the skin are numbered 6 * element + side (mechanics/mesh/skin.hpp).
  std::string face(global_id face) const;
  // Edges are numbered 4 * face + corner.
  std::string edge(global_id edge) const;

private:
  std::string elementId(global_id element) const;

  MPI_Comm _comm;
  const io::MeshPart& _part;
};

// A brick of a wall is also named by its course, wythe and place, as in the deck.
std::string bodyName(const Config& config, global_id body);

// A body of a mesh is also named by the element block of its first element. Collective.
std::string bodyName(MPI_Comm comm, const Config& config, const io::MeshPart& part, global_id body);

} // namespace brickwall::miniapp
