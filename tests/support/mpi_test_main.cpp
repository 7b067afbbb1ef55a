// GoogleTest under MPI and Kokkos: every rank runs every test; the run fails if a test fails on any rank. Rank 0
// reports its own results, the others only their failures.
#include "contact/base/backend.hpp"

#include <gtest/gtest.h>
#include <mpi.h>

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
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
  MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  MPI_Finalize();
  return failed;
}
