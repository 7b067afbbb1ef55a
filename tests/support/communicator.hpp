// The communicator of a test's ranks.
#pragma once

#include <mpi.h>

namespace brickwall {

inline const MPI_Comm comm = MPI_COMM_WORLD;

} // namespace brickwall
