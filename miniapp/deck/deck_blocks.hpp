// The blocks of a deck, group by group: their rules, and how they are read into Config with the
// checks that concern several keys.
#pragma once

#include "io/deck/deck.hpp"
#include "miniapp/deck/config.hpp"

namespace brickwall::miniapp {

io::Schema sceneBlocks(); // title, [wall], [mesh], [material.<name>], [element]
io::Schema loadBlocks(); // loads, boundary conditions, initial conditions
io::Schema methodBlocks(); // [contact], [search], [partition], [skip], [time]
io::Schema outputBlocks(); // [output], [limits]

void readScene(io::Deck& deck, Config& config);
void readLoads(io::Deck& deck, Config& config);
void readMethods(io::Deck& deck, Config& config);
void readOutput(const io::Deck& deck, Config& config);

} // namespace brickwall::miniapp
