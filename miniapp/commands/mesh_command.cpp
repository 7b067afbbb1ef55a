// `brickwall mesh`: writes the Exodus mesh of a deck.
#include "contact/base/mpi.hpp"
#include "io/exodus/mesh_writer.hpp"
#include "miniapp/commands/commands.hpp"
#include "miniapp/output/output_files.hpp"
#include "miniapp/output/report.hpp"
#include "miniapp/scene/scene.hpp"

#include <cstdio>

namespace brickwall::miniapp {

int writeMeshOnly(MPI_Comm comm, const Config& config, const Options& options) {
  const io::MeshPart part = makeMeshPart(comm, config);
  if (rankOf(comm) == 0)
    std::printf("%s: %s, %s, %s\n", options.caseName().c_str(),
                counted(part.num_global_elems, "element").c_str(),
                counted(part.num_global_nodes, "node").c_str(),
                counted(part.num_global_bodies, "body", "bodies").c_str());
  if (!options.write_output)
    return 0;
  io::ResultsConfig results;
  results.title = config.title;
  results.version = versionText();
  results.information = config.resolved_deck;
  const std::string path = options.output_directory + "/" + options.caseName() + ".exo";
  makeDirectory(comm, options.output_directory);
  if (config.mesh)
    refuseToReplace(comm, config.mesh->file, path);
  const FolderLock lock(comm, options.output_directory);
  io::writeMesh(comm, path, part, results);
  return 0;
}

} // namespace brickwall::miniapp
