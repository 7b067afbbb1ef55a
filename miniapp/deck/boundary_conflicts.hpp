// Boundary conditions of a deck that prescribe different motions of the same nodes.
#pragma once

#include "io/deck/deck.hpp"
#include "miniapp/deck/config.hpp"

#include <string>
#include <vector>

namespace brickwall::miniapp {

// A [[boundary.fixed]] or [[boundary.velocity]] entry. The velocity of a fixed set is 0.
struct Boundary {
  std::string block; // of the deck, for messages
  PrescribedVelocityConfig motion;
};
std::vector<Boundary> boundariesOf(const Config& config);

// The components that both motions prescribe, but differently, such as "x, z"; "" if there are
// none.
std::string differingComponents(const PrescribedVelocityConfig& a,
                                const PrescribedVelocityConfig& b);

// Adds a fault to `deck` for each boundary condition that prescribes a motion of a component of a
// node set other than that of an earlier entry. The fault names both places.
void complainOfConflicts(const Config& config, io::Deck& deck);

} // namespace brickwall::miniapp
