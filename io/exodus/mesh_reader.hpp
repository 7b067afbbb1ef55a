// Reads a hex8 mesh from one Exodus file so that each rank holds its part only.
#pragma once

#include "io/mesh/mesh_part.hpp"

#include <mpi.h>

#include <string>

namespace brickwall::io {

// Every rank reads a slice, RCB over element centroids assigns owners, and the slices are sent
// to them. Global element ids are positions in the file, whatever its maps say; nodes that no
// element uses are dropped and the others numbered in file order. Bodies are connected components.
// Blocks and sets without a name are called block_<id>, side_set_<id>, node_set_<id>; empty blocks
// are dropped. Distribution factors, attributes and results in the file are not read.
//
// Collective. Throws one InputError on all ranks that names the file: missing, not Exodus,
// truncated, no elements, no hex8 block, a block that is not hex8, node or element numbers out of
// range, an id twice in node_num_map or elem_num_map.
MeshPart readMesh(MPI_Comm comm, const std::string& file);

} // namespace brickwall::io
