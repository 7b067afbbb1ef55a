// Checksums by which a checkpoint knows its manifest and its mesh.
#pragma once

#include "io/mesh/mesh_part.hpp"

#include <mpi.h>

#include <cstdint>
#include <string>

namespace brickwall::miniapp {

// Of all letters.
std::uint64_t textChecksum(const std::string& text);

// Of all that results depend on: ids, positions, corners, names of blocks, names and content of
// side sets and node sets. The partition and the order of blocks and sets do not matter.
// Collective.
std::uint64_t meshChecksum(MPI_Comm comm, const io::MeshPart& part);

} // namespace brickwall::miniapp
