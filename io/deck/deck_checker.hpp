// Checks the tree of a deck against its schema and fills in the defaults.
#pragma once

#include "io/deck/deck.hpp"
#include "io/deck/deck_faults.hpp"
#include "io/deck/toml_tree.hpp"

#include <string>
#include <vector>

namespace brickwall::io {

// Value of one key in one block instance.
struct DeckValue {
  struct Entry {
    bool boolean = false;
    std::int64_t integer = 0;
    double real = 0;
    std::string text;
  };
  const KeyRule* rule = nullptr;
  bool is_given = false; // in the deck or by an override
  bool is_good = false; // given or default, without fault
  Position at; // of the value, or of the block when there is none
  std::vector<Entry> entries; // one for scalars
};

// One table: "wall", "material.brick", "load.pressure[0]".
struct DeckBlock {
  const BlockRule* rule = nullptr;
  std::string instance; // as Deck looks it up
  std::string header; // as in messages: "[wall]"
  std::string name; // of a named block: "brick"
  bool is_given = false;
  Position at;
  std::vector<DeckValue> values; // in the order of the rule's keys
};

// All block instances: for each rule of the schema in order, those of the deck; single blocks are
// always included. The result points into `schema`.
std::vector<DeckBlock> checkDeck(const TomlNode& root, const Schema& schema, DeckFaults& faults);

} // namespace brickwall::io
