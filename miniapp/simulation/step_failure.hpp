// Message of a step that failed.
#pragma once

#include <string>

namespace brickwall::miniapp {

class Simulation;

// Names the element, the contact or the load that failed, and a remedy where one is known. Before
// the step is undone; collective.
std::string describeFailure(const Simulation& simulation);

} // namespace brickwall::miniapp
