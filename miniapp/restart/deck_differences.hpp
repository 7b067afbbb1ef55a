// Whether a checkpoint belongs to a deck.
#pragma once

#include <string>

namespace brickwall::miniapp {

// Where two resolved decks differ first in what the results depend on, in words; "" if nowhere.
// Keys that no result depends on may differ: title, units, time.steps, limits.wall_time,
// search.decomposition, [output.checkpoint], [partition], [skip]; and mesh.file, since the mesh
// itself is compared.
std::string deckDifference(const std::string& of_checkpoint, const std::string& of_run);

} // namespace brickwall::miniapp
