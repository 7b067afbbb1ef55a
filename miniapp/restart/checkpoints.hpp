// Checkpoints of a run: OUTPUT/checkpoints/step-N/ with one netCDF-4 file for each rank and
// manifest.json. README.md describes them.
#pragma once

#include "miniapp/restart/run_restart.hpp"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace brickwall::miniapp {

class Checkpoints {
public:
  // Of runs of `config` that write to `output_directory`. `config` and `scene` must outlive the
  // object.
  Checkpoints(MPI_Comm comm, const Config& config, const Scene& scene,
              const std::string& output_directory)
      : _comm(comm), _config(config), _scene(scene), _folder(output_directory + "/checkpoints") {}

  // Writes a checkpoint beside the others, brings it to the disk and gives it its name; then
  // removes all but this one and the one before it. Returns its path. Throws OutputError on all
  // ranks; the others are then as they were. Collective.
  std::string write(const RunRestart& data, const Simulation& simulation);

  // Reads the checkpoint `which`: "latest", the folder of one or its manifest, or a folder of
  // several or of a run, which stands for the latest of them. Throws InputError on all ranks with
  // the reason why it cannot be used, and with the path of the nearest one that can be used: the
  // one before it, or else after it, in its folder or that of the run. Collective.
  RunRestart read(const std::string& which, const Simulation& simulation);

private:
  struct Opened; // manifest and tables
  void prepare(); // at the first use; collective
  std::string pathOf(const std::string& which) const; // collective
  Opened open(const std::string& path, bool reads_tables) const; // collective
  nlohmann::ordered_json manifestOf(const RunRestart& data,
                                    const std::vector<std::uint64_t>& parts) const;
  void removeOutdated(const std::string& latest) const; // on rank 0
  void checkManifest(const std::string& path, const nlohmann::ordered_json& manifest) const;
  std::vector<std::string> all(const std::string& folder) const; // on rank 0; oldest first
  std::string nearest(const std::string& path) const; // on rank 0; "" without any

  MPI_Comm _comm;
  const Config& _config;
  const Scene& _scene;
  std::string _folder;
  std::string _version, _commit;
  std::string _mesh; // checksum
};

} // namespace brickwall::miniapp
