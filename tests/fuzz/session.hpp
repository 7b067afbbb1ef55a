// MPI and a folder for files, as long as a fuzz target lives.
#pragma once

#include "tests/support/temporary_folder.hpp"

namespace brickwall::fuzz {

inline const testing::TemporaryFolder& folder() {
  struct Mpi {
    Mpi() {
      int provided = 0;
      MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    }
    ~Mpi() { MPI_Finalize(); }
  };
  static const Mpi mpi;
  static const testing::TemporaryFolder only(MPI_COMM_SELF); // removed before MPI ends
  return only;
}

} // namespace brickwall::fuzz
