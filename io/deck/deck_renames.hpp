// Former names of blocks, keys and words: each is replaced by the present one, with a warning.
#pragma once

#include "io/deck/deck.hpp"
#include "io/deck/deck_faults.hpp"
#include "io/deck/toml_tree.hpp"

#include <string>
#include <vector>

namespace brickwall::io {

// "load.pressure" -> {"load", "pressure"}
std::vector<std::string> splitDots(const std::string& name);

// In the tree of a deck. A former name beside the present one is a fault.
void renameInTree(const Schema& schema, TomlNode& root, DeckFaults& faults);

// In the path of an override, {"load", "pressure", "0", "peak"}, that stands at `here`.
void renameInPath(const Schema& schema, const Position& here, std::vector<std::string>& path,
                  DeckFaults& faults);

} // namespace brickwall::io
