// Writes a mesh and results to Exodus, one file per rank; `epu -auto` joins them to the file of a
// 1-rank run.
#pragma once

#include "io/mesh/mesh_part.hpp"

#include <mpi.h>

#include <memory>
#include <string>
#include <vector>

namespace brickwall::io {

enum class FileFormat {
  offset64, // netCDF 64-bit offset, the fastest; netCDF-4 replaces it where ids outgrow 32 bits
  netcdf4 // HDF5, compressed at level 1
};

struct ResultsConfig {
  std::string title; // up to 80 characters
  std::string program = "brickwall";
  std::string version; // for the QA record
  std::string information; // the resolved deck; lines over 80 characters are cut into records
  std::vector<std::string> nodal_names; // e.g. displacement_x, displacement_y, displacement_z
  std::vector<std::string> element_names; // e.g. stress_xx
  std::vector<std::string> global_names; // e.g. kinetic_energy
  bool write_brick_id = true; // adds the element variable brick_id (body number + 1), last
  bool write_processor_id = false; // adds the element variable processor_id, after it
  bool single_precision = false; // store floats
  // The names end with it until the caller renames the files, so that earlier ones stay as they
  // are.
  std::string temporary_suffix = {};
  FileFormat format = FileFormat::offset64;
};

// Name of this rank's file: `base` itself for one rank, otherwise base.N.r with r zero-padded to
// the width of N. `base` ends in .exo by convention.
std::string rankFileName(const std::string& base, int num_ranks, int rank);

class ResultsWriter {
public:
  // Creates this rank's file (an older one is overwritten) and writes the mesh. Collective. Throws
  // OutputError on all ranks, naming the file and the failed operation, when any rank fails.
  ResultsWriter(MPI_Comm comm, const std::string& base, const MeshPart& part,
                const ResultsConfig& config);
  ~ResultsWriter(); // closes without reporting errors
  ResultsWriter(ResultsWriter&&) noexcept;
  ResultsWriter& operator=(ResultsWriter&&) noexcept;

  // Appends one step and flushes it, so that it stays readable if the run is killed. Values are
  // nodal[variable][local node], element[variable][local element], global[variable] in the order of
  // the configured names; globals must be the same on every rank. Collective; throws as above, in
  // this step.
  void writeStep(double time, const std::vector<std::vector<double>>& nodal,
                 const std::vector<std::vector<double>>& element,
                 const std::vector<double>& global);

  int numSteps() const;
  const std::string& fileName() const; // of this rank, without the temporary suffix

  // Closes the file and reports errors. Collective; throws as above.
  void close();

private:
  struct State;
  std::unique_ptr<State> _state;
};

} // namespace brickwall::io
