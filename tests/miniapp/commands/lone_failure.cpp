// A program in which the last rank fails alone while the others wait for it, or, with the argument
// "of_all_ranks", every rank fails together. The test checks its exit code and that it ends (see
// CMakeLists.txt).
#include "contact/base/error.hpp"
#include "contact/base/mpi.hpp"
#include "miniapp/commands/failure.hpp"

#include <string>

int main(int argc, char** argv) {
  using namespace brickwall;
  MPI_Init(&argc, &argv);
  MPI_Comm guard = MPI_COMM_NULL;
  MPI_Comm_dup(MPI_COMM_WORLD, &guard);
  const bool all = argc > 1 && std::string(argv[1]) == "of_all_ranks";
  int code = 0;
  try {
    if (all || rankOf(MPI_COMM_WORLD) == sizeOf(MPI_COMM_WORLD) - 1)
      throw PhysicsError("element 7 is inverted");
    MPI_Barrier(MPI_COMM_WORLD); // never complete: the last rank does not come
  } catch (const std::exception& error) {
    code = miniapp::reportFailure(guard, error, 0.5);
  }
  MPI_Comm_free(&guard);
  MPI_Finalize();
  return code;
}
