// A program in which the last rank fails alone while the others wait for it: before a barrier
// ("of_one_rank"), in an exchange one of whose messages is too large ("in_an_exchange"), or in one
// for which it has no memory ("out_of_memory"); or every rank fails together ("of_all_ranks"). The
// test checks its exit code, its message and that it ends (see CMakeLists.txt).
#include "contact/base/error.hpp"
#include "contact/base/messages/exchange_plan.hpp"
#include "contact/base/mpi.hpp"
#include "miniapp/commands/failure.hpp"

#include <climits>
#include <cstdint>
#include <string>

extern std::size_t largest_allocation; // bytes, limited_allocation.cpp

namespace {

using namespace brickwall;

// Each rank sends eight words to the others; the last one has too many for the first rank, after it
// has begun to receive.
void exchange(bool is_last) {
  const exec_space space;
  const Communicator comm(MPI_COMM_WORLD);
  MessageBuffers buffers;
  growTo(space, buffers.send, 8 * sizeOf(comm));
  std::vector<int> partners;
  std::vector<std::int64_t> sent{0}, received{0};
  for (int q = 0; q < sizeOf(comm); ++q)
    if (q != rankOf(comm)) {
      const bool is_too_large = is_last && q == 0;
      partners.push_back(q);
      sent.push_back(sent.back() + (is_too_large ? std::int64_t(INT_MAX) + 1 : 8));
      received.push_back(received.back() + 8);
    }
  buffers.exchange(space, comm, 1, partners, sent, received);
}

// The last rank learns what it will receive, and has no memory for it.
void exchangeWithoutMemory(bool is_last) {
  constexpr std::size_t bytes = 1 << 20;
  const int size = sizeOf(MPI_COMM_WORLD);
  const std::vector<std::vector<char>> values(size, std::vector<char>(bytes));
  largest_allocation = is_last ? bytes - 1 : SIZE_MAX;
  exchangeByRank(MPI_COMM_WORLD, values);
}

} // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  Kokkos::initialize();
  MPI_Comm guard = MPI_COMM_NULL;
  MPI_Comm_dup(MPI_COMM_WORLD, &guard);
  const std::string what = argc > 1 ? argv[1] : "";
  const bool is_last = rankOf(MPI_COMM_WORLD) == sizeOf(MPI_COMM_WORLD) - 1;
  int code = 0;
  try {
    if (what == "in_an_exchange")
      exchange(is_last);
    else if (what == "out_of_memory")
      exchangeWithoutMemory(is_last);
    else if (what == "of_all_ranks" || is_last)
      throw PhysicsError("element 7 is inverted");
    MPI_Barrier(MPI_COMM_WORLD); // never complete: the last rank does not come
  } catch (const std::exception& error) {
    code = miniapp::reportFailure(guard, error, 0.5);
  }
  MPI_Comm_free(&guard);
  Kokkos::finalize();
  MPI_Finalize();
  return code;
}
