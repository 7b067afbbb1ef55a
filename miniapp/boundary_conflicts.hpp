// Boundary conditions of a deck that contradict each other.
#pragma once

#include "io/deck.hpp"
#include "miniapp/config.hpp"

namespace brickwall::miniapp {

// Adds a fault for each [[boundary.fixed]] and [[boundary.velocity]] of `config` that moves a component of a node set otherwise than one
// before it, naming both places. Node sets of different names may share nodes: these follow the later one.
void complainOfConflicts(const Config& config, io::Deck& deck);

} // namespace brickwall::miniapp
