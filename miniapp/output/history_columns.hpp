// The numbers of a moment: columns of history.csv and, by the same names and in the same order, globals of the Exodus
// file. Those of physics that the deck does not ask for are left out.
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
