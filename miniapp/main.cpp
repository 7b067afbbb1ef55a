// The program: starts MPI and Kokkos, runs one command, ends them. The only place that turns an
// exception into a message and an exit code.
#include "contact/base/backend.hpp"
#include "contact/base/error.hpp"
#include "contact/base/mpi.hpp"
#include "miniapp/commands/commands.hpp"
#include "miniapp/commands/companion.hpp"
#include "miniapp/commands/failure.hpp"

#include <cstdio>
#include <iostream>

namespace {

using namespace brickwall;
using namespace brickwall::miniapp;

int runCommand(MPI_Comm comm, const Config& config, const Options& options) {
  switch (options.command) {
  case Command::check:
    return checkScene(comm, config, options);
  case Command::mesh:
    return writeMeshOnly(comm, config, options);
  case Command::search:
    return runSearch(comm, config, options);
  case Command::run:
    break;
  }
  return runSimulation(comm, config, options);
}

// `guard` is only for failures, which are reported before Kokkos ends: on a faulty device it may
// not.
int runInsideKokkos(MPI_Comm comm, MPI_Comm guard, const Config& config, const Options& options,
                    const char* program) {
  std::vector<std::string> words = options.kokkos_arguments;
  words.insert(words.begin(), program);
  if (options.command == Command::check || options.command == Command::mesh)
    words.emplace_back("--kokkos-disable-warnings"); // on the binding of threads: for speed only
  std::vector<char*> arguments;
  for (std::string& word : words)
    arguments.push_back(word.data());
  int count = static_cast<int>(arguments.size());
  arguments.push_back(nullptr);
  letToolsSkipFences();
  try {
    Kokkos::initialize(count, arguments.data());
  } catch (const std::exception& error) { // a faulty --kokkos- argument
    throw InputError(std::string("Kokkos: ") + error.what());
  }
  int code = 0;
  try {
    if (count > 1) // Kokkos removes the arguments that it knows
      throw InputError(std::string("Kokkos does not know ") + arguments[1]);
    code = runCommand(comm, config, options);
  } catch (const std::exception& error) {
    code = reportFailure(guard, error);
  }
  Kokkos::finalize();
  return code;
}

// The deck is judged first, so that its faults stand alone, without what Kokkos prints as it
// starts.
int runProgram(MPI_Comm comm, const Options& options, const char* program) {
  MPI_Comm guard = MPI_COMM_NULL;
  checkMpi(MPI_Comm_dup(comm, &guard), "MPI_Comm_dup");
  int code = 0;
  try {
    const Config config = readConfig(comm, options.deck, options.overrides);
    if (rankOf(comm) == 0)
      for (const std::string& warning : config.warnings)
        std::cout << "warning: " << warning << std::endl;
    code = runInsideKokkos(comm, guard, config, options, program);
  } catch (const std::exception& error) {
    code = reportFailure(guard, error);
  }
  MPI_Comm_free(&guard);
  return code;
}

// `code`, or that of a failed output if standard output cannot be written: a full disk shows only
// here.
int withOutputFlushed(int code) {
  std::cout << std::flush;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout)
    return code;
  printMessage("error: standard output cannot be written");
  return code == 0 ? static_cast<int>(ExitCode::output) : code;
}

} // namespace

// An exception leaves main only if MPI itself fails outside the commands: std::terminate names it.
// NOLINTNEXTLINE(bugprone-exception-escape)
int main(int argc, char** argv) {
  if (const int code = startCompanion(argc, argv))
    return code;
  const CommandLine line = parseCommandLine(argc, argv);
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN); // checkMpi turns them into exceptions
  int code = line.exit_code;
  if (line.options) {
    code = runProgram(MPI_COMM_WORLD, *line.options, argv[0]);
  } else if (rankOf(MPI_COMM_WORLD) == 0) {
    (code == 0 ? std::cout : std::cerr) << line.text << std::flush;
  }
  code = withOutputFlushed(code);
  MPI_Finalize();
  return code;
}
