// The four things the program does. All are collective, return the exit code, and throw Error
// (every rank the same).
#pragma once

#include "miniapp/commands/command_line.hpp"
#include "miniapp/deck/config.hpp"

#include <mpi.h>

namespace brickwall::miniapp {

// `run`: the coupled simulation with its output, report, table, FOM line and PASS or FAIL.
int runSimulation(MPI_Comm comm, const Config& config, const Options& options);
// `check`: prints what the scene will model; writes nothing.
int checkScene(MPI_Comm comm, const Config& config, const Options& options);
// `mesh`: writes the Exodus mesh.
int writeMeshOnly(MPI_Comm comm, const Config& config, const Options& options);
// `search`: global and local search alone on the wall's surface, repeated; search.json and its table.
int runSearch(MPI_Comm comm, const Config& config, const Options& options);

} // namespace brickwall::miniapp
