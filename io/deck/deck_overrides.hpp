// Overrides of the command line, "load.pressure[0].peak=1e6", put into the tree of a deck.
#pragma once

#include "io/deck/deck.hpp"
#include "io/deck/deck_faults.hpp"
#include "io/deck/toml_tree.hpp"

#include <string>

namespace brickwall::io {

// Reads a value as --set and defaults spell it: TOML, but words and texts may be bare. `rule` null:
// unknown key. Throws TomlSyntaxError for lists, tables and numbers that are not TOML.
TomlNode parseLooseValue(const std::string& spelling, const KeyRule* rule);

// Puts override number `index` into the tree, making the tables it needs; the checker finds what
// does not fit the schema and names the option. Only an override without a place in the tree is a
// fault here.
void applyOverride(const std::string& text, int index, const Schema& schema, TomlNode& root,
                   DeckFaults& faults);

} // namespace brickwall::io
