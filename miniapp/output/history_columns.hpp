// The columns of history.csv, which are also the global variables of the Exodus file, by the same
// names and in the same order.
// Columns of physics that the deck does not use are omitted.
#pragma once

#include "miniapp/deck/config.hpp"

#include <string>
#include <vector>

namespace brickwall::miniapp {

class Simulation;

std::vector<std::string> globalNames(const Config& config);
// In the order of globalNames(simulation.config()). Collective.
std::vector<double> globalValues(const Simulation& simulation);

} // namespace brickwall::miniapp
