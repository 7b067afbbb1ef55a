// The four commands of the program. All are collective, return the exit code, and throw the same
// Error on every rank.
#pragma once

#include "miniapp/commands/command_line.hpp"
#include "miniapp/deck/config.hpp"

#include <mpi.h>

namespace brickwall::miniapp {

// `run`: the coupled simulation with its output, report, table, FOM line and PASS or FAIL.
int runSimulation(MPI_Comm comm, const Config& config, const Options& options);
// `check`: prints the contents of the scene; writes nothing.
int checkScene(MPI_Comm comm, const Config& config, const Options& options);
// `mesh`: writes the Exodus mesh.
int writeMeshOnly(MPI_Comm comm, const Config& config, const Options& options);
// `search`: global and local search alone on the surface of the wall, repeated; search.json and its
// table.
int runSearch(MPI_Comm comm, const Config& config, const Options& options);

} // namespace brickwall::miniapp
