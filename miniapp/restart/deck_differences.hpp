// Whether a checkpoint belongs to a deck.
#pragma once

#include <string>

namespace brickwall::miniapp {

// Where two resolved decks differ first in what the results depend on, in words; "" if nowhere.
// Keys that only decide when a run ends or writes checkpoints may differ: time.steps,
// limits.wall_time, [output.checkpoint], [partition]; and mesh.file, since the mesh itself is
// compared.
std::string deckDifference(const std::string& of_checkpoint, const std::string& of_run);

} // namespace brickwall::miniapp
