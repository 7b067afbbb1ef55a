// Overrides of the command line, "load.pressure[0].peak=1e6", put into the tree of a deck.
#pragma once

#include "io/deck/deck.hpp"
#include "io/deck/deck_faults.hpp"
#include "io/deck/toml_tree.hpp"

#include <string>

namespace brickwall::io {

// Reads a value as --set and defaults spell it: TOML, but words and texts may be bare. `rule` null: unknown key.
TomlNode parseLooseValue(const std::string& spelling, const KeyRule* rule);

// Puts override number `index` into the tree, making the tables it needs; what does not fit the schema is left to the
// checker, which then names the option. Only an override that can not be placed at all is a fault here.
void applyOverride(const std::string& text, int index, const Schema& schema, TomlNode& root,
                   DeckFaults& faults);

} // namespace brickwall::io
