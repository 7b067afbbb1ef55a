#include "miniapp/output/output_files.hpp"

#include "contact/base/mpi.hpp"
#include "io/exodus/results_writer.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace brickwall::miniapp {

void writeTextFile(MPI_Comm comm, const std::string& path, const std::string& text) {
  rethrowOnAllRanks(comm, [&] {
    if (rankOf(comm) != 0)
      return;
    std::FILE* file = std::fopen(path.c_str(), "w");
    if (!file)
      throw OutputError(path + ": cannot create the file: " + std::strerror(errno));
    const bool written =
        std::fwrite(text.data(), 1, text.size(), file) == text.size() && std::fflush(file) == 0;
    const int reason = errno;
    if ((std::fclose(file) != 0) || !written)
      throw OutputError(path +
                        ": cannot write the file: " + std::strerror(written ? errno : reason));
  });
}

bool fileExists(MPI_Comm comm, const std::string& path) {
  std::error_code ignored;
  int found = rankOf(comm) == 0 && std::filesystem::exists(path, ignored);
  broadcast(comm, &found, 1, 0);
  return found != 0;
}

void removeFile(MPI_Comm comm, const std::string& path) {
  rethrowOnAllRanks(comm, [&] {
    std::error_code error;
    if (rankOf(comm) == 0 && !std::filesystem::remove(path, error) && error)
      throw OutputError(path + ": cannot remove the file of an earlier run: " + error.message());
  });
}

void refuseToReplace(MPI_Comm comm, const std::string& input, const std::string& path) {
  rethrowOnAllRanks(comm, [&] {
    for (const std::string& result : {path, io::rankFileName(path, sizeOf(comm), rankOf(comm))}) {
      std::error_code ignored; // a file that does not exist is not replaced
      if (std::filesystem::equivalent(input, result, ignored))
        throw InputError(input + ": found the file that the results would replace, " + result +
                         ", expected another one: name another folder with -o");
    }
  });
}

FolderLock::FolderLock(MPI_Comm comm, const std::string& path) {
  rethrowOnAllRanks(comm, [&] {
    if (rankOf(comm) != 0)
      return;
    _descriptor = open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (_descriptor >= 0 && flock(_descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
      throw OutputError(path + ": another run is writing to this folder");
  });
}

FolderLock::~FolderLock() {
  if (_descriptor >= 0)
    close(_descriptor);
}

void makeDirectory(MPI_Comm comm, const std::string& path) {
  rethrowOnAllRanks(comm, [&] {
    if (rankOf(comm) != 0)
      return;
    std::error_code error;
    std::filesystem::create_directories(path, error);
    std::error_code ignored; // that of create_directories() is the reason
    if (!std::filesystem::is_directory(path, ignored))
      throw OutputError(path + ": cannot make the output folder: " +
                        (error ? error.message() : "a file has this name"));
  });
}

} // namespace brickwall::miniapp
