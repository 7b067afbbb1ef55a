// Turns an exception into a message and an exit code, so that no rank hangs.
#pragma once

#include <mpi.h>

#include <exception>

namespace brickwall::miniapp {

// To be called by every rank that has caught `error`; `comm` has no other use. When all ranks call
// it within `patience` seconds, rank 0 prints its message, and every rank returns the same exit
// code (the largest). Otherwise this rank failed alone while others continue or wait for it: it
// prints its message with its rank and aborts all of them with the code.
int reportFailure(MPI_Comm comm, const std::exception& error, double patience = 10);

} // namespace brickwall::miniapp
