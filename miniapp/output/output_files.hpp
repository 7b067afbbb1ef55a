// Files and folders of the output. All functions are collective: rank 0 acts, and a failure is an
// OutputError on every rank.
#pragma once

#include <mpi.h>

#include <string>

namespace brickwall::miniapp {

// Writes a text to a file, checked to the last byte.
void writeTextFile(MPI_Comm comm, const std::string& path, const std::string& text);
// Removes the file if it exists.
void removeFile(MPI_Comm comm, const std::string& path);
// Creates the folder and those above it.
void makeDirectory(MPI_Comm comm, const std::string& path);

} // namespace brickwall::miniapp
