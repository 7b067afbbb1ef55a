// A results file without results.
#include "io/exodus/mesh_writer.hpp"

namespace brickwall::io {

void writeMesh(MPI_Comm comm, const std::string& base, const MeshPart& part,
               const ResultsConfig& config) {
  ResultsConfig mesh_only = config;
  mesh_only.nodal_names.clear();
  mesh_only.element_names.clear();
  mesh_only.global_names.clear();
  mesh_only.write_brick_id = false;
  mesh_only.write_processor_id = false;
  ResultsWriter(comm, base, part, mesh_only).close();
}

} // namespace brickwall::io
