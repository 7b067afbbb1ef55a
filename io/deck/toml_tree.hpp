// TOML text as a plain tree with the position of each value. toml11 is included by toml_tree.cpp
// only.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace brickwall::io {

// A place in the deck, or an override of the command line.
struct Position {
  int line = 1; // from 1
  int column = 1; // in bytes, from 1
  int length = 1; // bytes on that line
  int option = -1; // index of the override; -1: in the deck
};

struct TomlNode {
  enum class Kind { boolean, integer, real, text, date, list, table };

  Kind kind = Kind::table;
  bool boolean = false;
  std::int64_t integer = 0;
  double real = 0;
  bool overflows = false; // a number too large for its type
  std::string text; // of a text its value, of a number or date its spelling
  std::vector<TomlNode> entries; // of a list
  std::vector<std::pair<std::string, TomlNode>> members; // of a table, in the order of the text
  Position at; // of the value; of a table, its header
  Position key_at; // of the key, for members of tables

  const TomlNode* member(const std::string& name) const;
  TomlNode* member(const std::string& name);
  // As in a message: `the integer 3`, `a list of 2`.
  std::string describe() const;
};

// A syntax error: its position, the text found, and the text that TOML requires there.
struct TomlSyntaxError : std::runtime_error {
  TomlSyntaxError(Position where, const std::string& found, const std::string& expectation)
      : std::runtime_error(found), at(where), expected(expectation) {}
  Position at;
  std::string expected;
};

// The text without byte-order mark and with "\n" line ends, as parseToml expects it.
std::string normalizeText(std::string text);

// The lines of a text, without line ends; at least one.
std::vector<std::string> splitLines(const std::string& text);

// Throws TomlSyntaxError at the first fault.
TomlNode parseToml(const std::string& text);

// Whether the text contains a number such as -.5, which TOML writes -0.5.
bool hasNumberWithoutLeadingDigit(const std::string& text);

// A single value, as after "key ="; throws TomlSyntaxError.
TomlNode parseTomlValue(const std::string& text);

} // namespace brickwall::io
