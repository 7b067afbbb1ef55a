// Syntax errors of toml11 in words of a deck: what was found, and what was expected.
#pragma once

#include "io/deck/toml_tree.hpp"

#include <string>

namespace brickwall::io {

// `found` is the message of toml11 without the name of its function, `remark` its note at the
// place: the value that it expected, or more of the value found. The result has an expectation
// whatever they are.
TomlSyntaxError syntaxErrorInWords(const Position& at, std::string found, std::string remark);

} // namespace brickwall::io
