// The faults and warnings of a deck, collected and reported together, in the order of the deck's
// lines.
#pragma once

#include "io/deck/toml_tree.hpp"

#include <string>
#include <vector>

namespace brickwall::io {

class DeckFaults {
public:
  // `lines` of the deck, `overrides` as given with --set: the excerpts.
  DeckFaults(std::string path, std::vector<std::string> lines, std::vector<std::string> overrides);

  // `subject`: "[wall] gap" or "". `found` and `expected` complete "found ..., expected ...";
  // `expected` and `nearest` (the nearest valid name) may be "".
  void add(const Position& at, const std::string& subject, const std::string& found,
           const std::string& expected, const std::string& nearest = "");
  void warn(const Position& at, const std::string& text);
  // `a.toml:12`, or `--set a.b=c`.
  std::string placeOf(const Position& at) const;
  int count() const { return static_cast<int>(_faults.size()); }
  int numLines() const { return static_cast<int>(_lines.size()); }
  // All faults, sorted; "" if there are none.
  std::string message() const;
  // `a.toml:12: the text`, sorted.
  std::vector<std::string> warnings() const;

private:
  struct Fault {
    Position at;
    std::string subject, found, expected, nearest;
  };
  static std::vector<Fault> sorted(std::vector<Fault> faults);
  std::string describe(const Fault& fault) const;

  std::string _path;
  std::vector<std::string> _lines, _overrides;
  std::vector<Fault> _faults, _warnings; // a warning has only `found`
};

} // namespace brickwall::io
