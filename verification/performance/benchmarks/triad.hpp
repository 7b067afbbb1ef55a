// The memory bandwidth with which figures of the same run are compared.
#pragma once

#include <mpi.h>

namespace brickwall::peers {

// Collective. STREAM triad a = b + s c (McCalpin 1995) on three arrays of `mebibytes` each and
// rank, all ranks at once. Best of 10, bytes per second summed over the ranks; 24 bytes an entry;
// the read of the stored cache line is not counted.
double triadBandwidth(MPI_Comm comm, int mebibytes);

} // namespace brickwall::peers
