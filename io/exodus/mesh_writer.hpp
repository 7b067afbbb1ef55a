// Writes a mesh alone, for `brickwall mesh`.
#pragma once

#include "io/exodus/results_writer.hpp"
#include "io/mesh/mesh_part.hpp"

#include <mpi.h>

#include <string>

namespace brickwall::io {

// The same files as those of ResultsWriter, without variables and steps (the names in `config` are
// ignored).
// Collective; throws OutputError on all ranks.
void writeMesh(MPI_Comm comm, const std::string& base, const MeshPart& part,
               const ResultsConfig& config);

} // namespace brickwall::io
