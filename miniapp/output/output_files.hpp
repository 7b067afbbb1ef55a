// Files and folders of the output. All functions are collective: rank 0 acts, unless said, and a
// failure is an OutputError on every rank.
#pragma once

#include <mpi.h>

#include <string>
#include <utility>

namespace brickwall::miniapp {

// Writes a text to a file, checked to the last byte.
void writeTextFile(MPI_Comm comm, const std::string& path, const std::string& text);
// Whether there is such a file or folder.
bool fileExists(MPI_Comm comm, const std::string& path);
// Removes the file if it exists.
void removeFile(MPI_Comm comm, const std::string& path);
// Throws InputError if the file `input` that the run reads is, under this or another name, one that
// results of the base name `path` would replace: that file, or one of a rank. Every rank looks.
void refuseToReplace(MPI_Comm comm, const std::string& input, const std::string& path);
// A lock of a folder while the object lives, so that no two runs write there: ranks of a run whose
// launcher was killed may still be at work.
class FolderLock {
public:
  FolderLock() = default;
  // Collective; throws OutputError if another process holds the lock. File systems without locks
  // are accepted.
  FolderLock(MPI_Comm comm, const std::string& path);
  ~FolderLock();
  FolderLock(FolderLock&& other) noexcept { std::swap(_descriptor, other._descriptor); }
  FolderLock& operator=(FolderLock&& other) noexcept {
    std::swap(_descriptor, other._descriptor);
    return *this;
  }

private:
  int _descriptor = -1; // on rank 0
};

// Creates the folder and those above it.
void makeDirectory(MPI_Comm comm, const std::string& path);

} // namespace brickwall::miniapp
