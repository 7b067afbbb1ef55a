// The main function of a benchmark: MPI and Kokkos stand while it runs, and an exception ends it
// with exit code 1.
#pragma once

#include "contact/base/backend.hpp"

#include <mpi.h>

#include <cstdio>
#include <exception>

namespace brickwall {

template <class Run>
int benchmarkMain(int argc, char** argv, const Run& run) {
  int provided = 0, code = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  Kokkos::initialize(argc, argv);
  try {
    run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    code = 1;
  }
  Kokkos::finalize();
  MPI_Finalize();
  return code;
}

} // namespace brickwall
