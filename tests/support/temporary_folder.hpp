// A folder for the files of a test on several ranks.
#pragma once

#include "contact/base/mpi.hpp"

#include <cstdlib>
#include <filesystem>
#include <string>

namespace brickwall::testing {

// A folder of its own for each test, made by rank 0 and removed when the last rank is done.
class TemporaryFolder {
public:
  explicit TemporaryFolder(MPI_Comm comm) : _comm(comm) {
    std::string name = (std::filesystem::temp_directory_path() / "brickwall_test_XXXXXX").string();
    if (rankOf(comm) == 0 && mkdtemp(name.data()) == nullptr)
      name.clear();
    _path = broadcast(comm, name);
  }
  ~TemporaryFolder() {
    MPI_Barrier(_comm);
    std::error_code error;
    if (rankOf(_comm) == 0)
      std::filesystem::remove_all(_path, error);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string operator/(const std::string& file) const { return _path + "/" + file; }

private:
  MPI_Comm _comm;
  std::string _path;
};

} // namespace brickwall::testing
