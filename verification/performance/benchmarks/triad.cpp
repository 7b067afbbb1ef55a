#include "verification/performance/benchmarks/triad.hpp"

#include "contact/base/backend.hpp"
#include "contact/base/mpi.hpp"

namespace brickwall::peers {

double triadBandwidth(MPI_Comm comm, int mebibytes) {
  const exec_space space;
  const std::int64_t n = std::int64_t(mebibytes) * 1024 * 1024 / std::int64_t(sizeof(double));
  const auto a = allocate<View<double*>>(space, "triad::a", n);
  const auto b = allocate<View<double*>>(space, "triad::b", n);
  const auto c = allocate<View<double*>>(space, "triad::c", n);
  Kokkos::parallel_for( // each thread touches its own pages first
      "triad::fill", rangePolicy(space, n), KOKKOS_LAMBDA(const std::int64_t i) {
        a(i) = 0;
        b(i) = static_cast<double>(i % 7);
        c(i) = 1;
      });
  space.fence();
  double best = 0;
  for (int repetition = 0; repetition < 10; ++repetition) {
    barrier(comm);
    const double start = MPI_Wtime();
    Kokkos::parallel_for(
        "triad", rangePolicy(space, n),
        KOKKOS_LAMBDA(const std::int64_t i) { a(i) = b(i) + 3.0 * c(i); });
    space.fence();
    const double seconds = allReduce(comm, MPI_Wtime() - start, MPI_MAX);
    best = std::max(best, 3.0 * sizeof(double) * static_cast<double>(n) * sizeOf(comm) / seconds);
  }
  double wrong = 0;
  Kokkos::parallel_reduce(
      "triad::check", rangePolicy(space, n),
      KOKKOS_LAMBDA(const std::int64_t i, double& sum) {
        sum += a(i) == static_cast<double>(i % 7) + 3.0 ? 0.0 : 1.0;
      },
      wrong);
  if (wrong != 0)
    throw Error(ExitCode::internal, "triadBandwidth: wrong results");
  return best;
}

} // namespace brickwall::peers
