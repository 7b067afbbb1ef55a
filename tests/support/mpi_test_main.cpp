// GoogleTest under MPI and Kokkos: every rank runs every test; the run fails if a test fails on any
// rank. Rank 0 reports its own results, the others only their failures.
#include "contact/base/backend.hpp"

#include <gtest/gtest.h>
#include <mpi.h>

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/lsan_interface.h>
#endif

namespace {

// LeakSanitizer, where it is compiled in. Leaks are looked for before MPI ends: it then unloads its
// plug-ins, and what they keep could not be attributed to them.
#if defined(__SANITIZE_ADDRESS__)
void watchAllocations(bool watch) {
  watch ? __lsan_enable() : __lsan_disable();
}
bool hasLeaks() {
  return __lsan_do_recoverable_leak_check() != 0;
}
#else
void watchAllocations(bool) {}
bool hasLeaks() {
  return false;
}
#endif

} // namespace

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  int provided = 0;
  watchAllocations(false);
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  watchAllocations(true);
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  int failed = 0;
  Kokkos::initialize(argc, argv);
  {
    if (rank != 0) {
      auto& listeners = ::testing::UnitTest::GetInstance()->listeners();
      class OnlyFailures : public ::testing::EmptyTestEventListener {
        void OnTestPartResult(const ::testing::TestPartResult& result) override {
          if (result.failed())
            std::printf("rank failure in %s:%d: %s\n", result.file_name() ? result.file_name() : "",
                        result.line_number(), result.message());
        }
      };
      delete listeners.Release(listeners.default_result_printer());
      listeners.Append(new OnlyFailures);
    }
    failed = RUN_ALL_TESTS();
  }
  Kokkos::finalize();
  if (hasLeaks())
    failed = 1;
  MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  MPI_Finalize();
  return failed;
}
