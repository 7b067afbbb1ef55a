#include "miniapp/output/output_files.hpp"

#include "contact/base/mpi.hpp"

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

void removeFile(MPI_Comm comm, const std::string& path) {
  rethrowOnAllRanks(comm, [&] {
    std::error_code error;
    if (rankOf(comm) == 0 && !std::filesystem::remove(path, error) && error)
      throw OutputError(path + ": cannot remove the file of an earlier run: " + error.message());
  });
}

void makeDirectory(MPI_Comm comm, const std::string& path) {
  rethrowOnAllRanks(comm, [&] {
    if (rankOf(comm) != 0)
      return;
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (!std::filesystem::is_directory(path))
      throw OutputError(path + ": cannot make the output folder: " +
                        (error ? error.message() : "a file has this name"));
  });
}

} // namespace brickwall::miniapp
