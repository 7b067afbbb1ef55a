// Keys of a deck that have no effect beside other keys, where that is easily overlooked.
#pragma once

#include "io/deck/deck.hpp"
#include "miniapp/deck/config.hpp"

namespace brickwall::miniapp {

// Adds a warning to the deck for each of them: a stiffness of friction without friction, an
// interval of rebalancing without rebalancing, and initial conditions that later ones replace in
// all bodies. Defaults, which a resolved deck holds too, cause none.
void warnOfUnusedKeys(const Config& config, io::Deck& deck);

} // namespace brickwall::miniapp
