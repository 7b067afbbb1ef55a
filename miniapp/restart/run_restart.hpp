// What a run carries from step to step, and its tables in restart files.
#pragma once

#include "miniapp/output/run_output.hpp"
#include "miniapp/restart/entity_tables.hpp"

#include <vector>

namespace brickwall::miniapp {

// All of it: README.md of this folder lists what it holds, and what follows from the deck instead.
struct RunRestart {
  SimulationRestart simulation;
  OutputRestart output;
  LimitWatch::Reported reported_limits = {};
  bool has_large_strain = false; // in a linear material
  std::vector<std::string> warnings; // of the time loop so far
  std::string note; // a warning of this restart, on rank 0; "" for none
};

// The tables of this rank's file: entities that this rank owns, by global id; values that all ranks
// share stand in the file of rank 0. Not collective.
std::vector<io::Table> tablesOf(const RunRestart& data, const Simulation& simulation);

// The reverse, from the tables of several files of a run on any number of ranks: each rank gives
// those that it has read and takes what its part of `simulation` needs; rank 0 has read the file of
// rank 0. Warnings are not in the tables. Throws InputError on all ranks for tables of another mesh
// or build. Collective.
RunRestart fromTables(const TableFiles& files, const Simulation& simulation);

} // namespace brickwall::miniapp
