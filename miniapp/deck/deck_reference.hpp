// The table of keys as a page for users, miniapp/deck/reference.md.
#pragma once

#include "io/deck/deck.hpp"

#include <string>

namespace brickwall::miniapp {

// The page in Markdown: a section for each block with a table of its keys.
std::string deckReference(const io::Schema& schema);

} // namespace brickwall::miniapp
