// This rank's part of the scene that a deck describes: mesh on host and device, skin, masses, sets
// by name.
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
  View<double*> mass; // [node]
  View<double*> mass_shares; // [elem] least share of the row sum in the body; empty: 1
  std::vector<unsigned char> node_is_owned; // host copy [node]
  global_id num_faces = 0; // exterior faces of all ranks
  double shortest_edge = 0, longest_edge = 0; // of all skin faces of all ranks, length
  std::vector<std::string> warnings; // equal on all ranks
};

// Reads or generates the mesh, assigns the materials, and finds skin and masses. Throws InputError
// on all ranks that lists
//  - names of sets and blocks that the mesh lacks, ambiguous names, blocks without a material;
//  - bodies that the mesh lacks; node sets that share nodes but have different prescribed motions;
//  - a mesh that cannot be read; an invalid element.
// Collective.
Scene makeScene(const exec_space& space, MPI_Comm comm, const Config& config);
// The same of a mesh that is there.
Scene makeScene(const exec_space& space, MPI_Comm comm, const Config& config, io::MeshPart part);

// The nodes that this rank shares with others, in the form that mechanics needs.
mechanics::SharedNodeLists sharedNodes(const io::MeshPart& part);

// The mesh only, on the host. Collective.
io::MeshPart makeMeshPart(MPI_Comm comm, const Config& config);

// Throws InputError if an initial condition names a body that a scene with `num_bodies` bodies
// lacks.
void refuseUnknownBodies(const Config& config, global_id num_bodies);

// Sets by name. They throw InputError that names the set and the most similar existing name.
const io::SideSet& sideSetOf(const io::MeshPart& part, const std::string& name);
const io::NodeSet& nodeSetOf(const io::MeshPart& part, const std::string& name);

} // namespace brickwall::miniapp
