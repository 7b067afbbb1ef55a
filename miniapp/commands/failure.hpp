// Messages on standard error, and exceptions turned into a message and an exit code, so that no
// rank hangs.
#pragma once

#include <mpi.h>

#include <exception>
#include <string>

namespace brickwall::miniapp {

// Writes the line "brickwall: `text`" to standard error in one call, so that a launcher, which
// reads it beside standard output, does not tear it.
void printMessage(const std::string& text);

// To be called by every rank that has caught `error`; `comm` has no other use. When all ranks call
// it within `patience` seconds, rank 0 prints its message, and every rank returns the same exit
// code (the largest). Otherwise this rank failed alone while others continue or wait for it: it
// prints its message with its rank and aborts all of them with the code.
int reportFailure(MPI_Comm comm, const std::exception& error, double patience = 5);

} // namespace brickwall::miniapp
