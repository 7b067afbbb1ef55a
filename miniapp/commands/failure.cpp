#include "miniapp/commands/failure.hpp"

#include "contact/base/mpi.hpp"
#include "io/deck/terminal_text.hpp"
#include "miniapp/timing/stopwatch.hpp"

#include <chrono>
#include <iostream>
#include <new>
#include <thread>

namespace brickwall::miniapp {
namespace {

int codeOf(const std::exception& error) {
  const auto* ours = dynamic_cast<const Error*>(&error);
  return static_cast<int>(ours ? ours->code() : ExitCode::internal);
}

std::string messageOf(const std::exception& error) {
  if (dynamic_cast<const std::bad_alloc*>(&error))
    return "out of memory: use more ranks or a smaller deck";
  return error.what();
}

// Whether all ranks reach this point in time.
bool allRanksArrive(MPI_Comm comm, double patience) {
  MPI_Request request;
  if (MPI_Ibarrier(comm, &request) != MPI_SUCCESS)
    return false;
  const Stopwatch waited;
  int done = 0;
  while (MPI_Test(&request, &done, MPI_STATUS_IGNORE) == MPI_SUCCESS && !done &&
         waited.seconds() < patience)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return done != 0;
}

} // namespace

void printMessage(const std::string& text) {
  std::cerr << "brickwall: " + io::terminalText(text) + '\n' << std::flush;
}

int reportFailure(MPI_Comm comm, const std::exception& error, double patience) {
  const int code = codeOf(error);
  std::cout << std::flush;
  if (allRanksArrive(comm, patience)) {
    if (rankOf(comm) == 0)
      printMessage("error: " + messageOf(error));
    return allReduce(comm, code, MPI_MAX);
  }
  printMessage("error on rank " + std::to_string(rankOf(comm)) + " alone: " + messageOf(error));
  MPI_Abort(comm, code);
  return code;
}

} // namespace brickwall::miniapp
