// The scene that a deck describes, as this rank holds it: mesh on host and device, skin, masses, sets by name.
#pragma once

#include "io/mesh/mesh_part.hpp"
#include "io/wall/wall_layout.hpp"
#include "mechanics/mesh/hex_mesh.hpp"
#include "mechanics/mesh/shared_node_sum.hpp"
#include "mechanics/mesh/skin.hpp"
#include "miniapp/deck/config.hpp"

#include <mpi.h>

#include <string>
#include <vector>

namespace brickwall::miniapp {

struct Scene {
  io::MeshPart part; // host: for sets and output
  mechanics::HexMesh mesh;
  mechanics::SharedNodeSum shared;
  mechanics::Skin skin;
  View<double*> mass; // lumped [node]
  std::vector<unsigned char> node_is_owned; // host copy [node]
  global_id num_faces = 0; // exterior faces of all ranks
  double shortest_edge = 0, longest_edge = 0; // of all skin faces of all ranks, length
  std::vector<std::string> warnings; // of what the deck asks of this mesh; equal on all ranks
};

// Reads or generates the mesh, gives every block its material, and finds skin and masses. Collective. Throws
// InputError (on all ranks) with all names of sets and blocks that the mesh lacks, of sets that it has twice, and all blocks without material; also
// for bodies that the mesh lacks, for node sets that share nodes but move them otherwise, for a mesh that cannot be read and for
// a bad element.
Scene makeScene(const exec_space& space, MPI_Comm comm, const Config& config);

// The nodes that this rank shares, as the mechanics lists them.
mechanics::SharedNodeLists sharedNodes(const io::MeshPart& part);

// The mesh alone, still on the host. Collective.
io::MeshPart makeMeshPart(MPI_Comm comm, const Config& config);

// Throws InputError where an initial condition names a body that a scene of so many bodies lacks.
void refuseUnknownBodies(const Config& config, global_id num_bodies);

// The generator's view of [wall].
io::WallConfig toWallConfig(const WallConfig& wall);

// Sets by name. Throw InputError that names the set and the nearest name there is.
const io::SideSet& sideSetOf(const io::MeshPart& part, const std::string& name);
const io::NodeSet& nodeSetOf(const io::MeshPart& part, const std::string& name);

} // namespace brickwall::miniapp
