// Values and blocks of a deck as TOML.
#pragma once

#include "io/deck/deck_checker.hpp"

#include <string>

namespace brickwall::io {

// The header of a block, `name` being that of an instance: "[wall]", "[material.<name>]",
// "[[load.pressure]]".
std::string headerOf(const BlockRule& rule, const std::string& name = "<name>");

// The shortest spelling that reads back to the same bits: with a point or an exponent, as TOML
// requires of a real.
std::string spellReal(double value);

// A block with its values, defaults filled in; "" for a block that is not given and has required
// keys or no values.
std::string spellBlock(const DeckBlock& block);

} // namespace brickwall::io
