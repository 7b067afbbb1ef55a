// Values of nodes, edges and contacts as tables of restart files, with the global id in the first
// column, so that ranks of another partition find theirs.
#pragma once

#include "io/checkpoint/table_file.hpp"
#include "miniapp/simulation/simulation.hpp"

#include <vector>

namespace brickwall::miniapp {

// The tables of each file that a rank has read.
using TableFiles = std::vector<std::vector<io::Table>>;

// The tables of this rank: nodes that it owns, its contacts, the boxes of its last search.
std::vector<io::Table> entityTables(const SimulationRestart& data, const Simulation& simulation);

// Replaces the values of nodes, edges and contacts in `data` by those of this rank's part of
// `simulation`; data.keeps_forces is set already. Throws InputError on all ranks for tables of
// another mesh or build. Collective.
void takeEntities(const TableFiles& files, const Simulation& simulation, SimulationRestart& data);

} // namespace brickwall::miniapp
