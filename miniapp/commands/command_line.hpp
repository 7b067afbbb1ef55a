// The command line: brickwall [run|check|mesh|search] [DECK] [options].
#pragma once

#include "miniapp/timing/timing.hpp"

#include <optional>
#include <string>
#include <vector>

namespace brickwall::miniapp {

enum class Command { run, check, mesh, search };

struct Options {
  Command command = Command::run;
  std::string deck = "inputs/brick_wall.toml";
  std::string output_directory; // default out/<deck name>
  bool write_output = true; // false with --no-output: no file at all is written
  Timing timing = Timing::normal;
  bool quiet = false; // no progress and no tables
  bool checksums = false; // print those of each part of each step
  std::optional<double> time_limit; // s of wall clock since the start of the run
  std::string restart; // "latest" or the path of a checkpoint; "": a run from the start
  std::optional<double> extend_to; // time at which a restarted run ends, in place of its end
  std::vector<std::string> overrides; // from --set, and from --steps as "time.steps=N"
  std::vector<std::string> kokkos_arguments; // --kokkos-*, for Kokkos::initialize

  // The deck's file name without folder and suffix: the base name of all output files.
  std::string caseName() const;
};

// Either the options, or a text to print and the exit code to end with (-h, --version, faults).
struct CommandLine {
  std::optional<Options> options;
  std::string text;
  int exit_code = 0;
};

// Reads argv; needs no MPI, prints nothing.
CommandLine parseCommandLine(int argc, const char* const* argv);

} // namespace brickwall::miniapp
