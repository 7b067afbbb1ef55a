// Whether a checkpoint belongs to a deck.
#pragma once

#include <string>

namespace brickwall::miniapp {

// Where two resolved decks differ first in what the results depend on, in words; "" if nowhere.
// Keys that no result depends on may differ: time.steps, limits.wall_time, [output.checkpoint],
// search.decomposition, [partition]; and mesh.file, since the mesh itself is compared.
std::string deckDifference(const std::string& of_checkpoint, const std::string& of_run);

} // namespace brickwall::miniapp
