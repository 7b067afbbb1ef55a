// An input deck: TOML text checked against a table of known blocks and keys. All faults of a deck
// are found in one pass and reported together, sorted by line, each with file:line, an excerpt, the
// value found and the value expected. Checks of the host code join the same list: complain(), then
// finish().
#pragma once

#include <mpi.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace brickwall::io {

enum class ValueType {
  boolean,
  integer, // 64-bit; a real is an error
  real, // finite; an integer is a real too
  word, // one of KeyRule::words
  text // any string
};

// One known key. Rules are written as chains: real("gap", "m", "...").byDefault(0.0).atLeast(0).
struct KeyRule {
  static constexpr int scalar = 0;
  static constexpr int any_length = -1;

  std::string name;
  ValueType type = ValueType::real;
  int length = scalar; // `scalar`, the exact length of a list, or `any_length` (at least one entry)
  std::string unit; // "" for pure numbers
  std::string help; // one line
  std::string fallback; // default, spelled as for --set: TOML, words and texts bare; "" for none
  std::string former_name; // accepted with a warning; "" for none
  bool required = false;
  double lower = -std::numeric_limits<double>::infinity(); // bounds of every entry
  double upper = std::numeric_limits<double>::infinity();
  bool lower_is_open = false, upper_is_open = false; // true: the bound itself is not allowed
  std::vector<std::string> words;
  // Former word and present word, for words that are accepted with a warning.
  std::vector<std::pair<std::string, std::string>> former_words;

  KeyRule& in(const std::string& unit_name);
  KeyRule& mustBeGiven(); // drops the default
  KeyRule& optional(); // likewise
  KeyRule& byDefault(const std::string& toml);
  KeyRule& byDefault(double value); // none where it is not finite
  KeyRule& formerly(const std::string& former);
  KeyRule& list(int entries);
  KeyRule& atLeast(double bound);
  KeyRule& above(double bound);
  KeyRule& atMost(double bound);
  KeyRule& below(double bound);
};

// A key without default that is not required is optional: Deck::has() says whether it is given.
KeyRule boolean(const std::string& name, const std::string& help);
KeyRule integer(const std::string& name, const std::string& help);
KeyRule real(const std::string& name, const std::string& unit, const std::string& help);
KeyRule word(const std::string& name, std::vector<std::string> words, const std::string& help);
KeyRule text(const std::string& name, const std::string& help);

enum class BlockKind {
  top, // keys before the first table; its name is ""
  single, // [wall]
  named, // [material.<name>], any number
  repeated // [[load.pressure]], any number
};

struct BlockRule {
  // Dotted, without <name> or brackets: "wall", "material", "load.pressure". Below a `single`
  // block, such as "search" and "search.reuse", it is a table inside that one: reuse = { ... }
  // there, or [search.reuse].
  std::string name;
  BlockKind kind = BlockKind::single;
  std::string help; // one line
  std::vector<KeyRule> keys = {};
  // A `single` block that must be given. Required keys count in given blocks only.
  bool required = false;
  // Former last component of `name`, accepted with a warning; "" for none. Not for `repeated`
  // blocks.
  std::string former_name = {};
};

using Schema = std::vector<BlockRule>;

// The values that a rule allows, as in a message: "a list of 3 integers each at least 1".
std::string describeValue(const KeyRule& rule);

// The text of `help`, one key a line with type, unit, default and range: for `brickwall --keys` and
// the README.
std::string describe(const Schema& schema);

// The name in `candidates` nearest to `name` by edit distance, or "" when none is near.
std::string nearestName(const std::string& name, const std::vector<std::string>& candidates);

// A checked deck. Values are looked up by block instance and key; an instance is spelled "wall",
// "material.brick" or "load.pressure[0]" (names() and count() list them). Looking up a key that the
// schema lacks throws Error (an error of the caller); a key whose value is faulty or missing yields
// its default, or zero, "" or an empty list, so that checking goes on to the end.
class Deck {
public:
  // Collective: rank 0 reads the file, every rank gets the text. `overrides` are "block.key=value"
  // as in --set: "load.pressure[0].peak=1e6" or "load.pressure.0.peak=1e6"; values are TOML, bare
  // words are strings. Throws InputError at once when the file cannot be read or is not TOML; other
  // faults wait for finish().
  static Deck read(MPI_Comm comm, const std::string& path,
                   const std::vector<std::string>& overrides, const Schema& schema);
  // The same from a text in memory; `path` is only the name in messages. Not collective.
  static Deck parse(const std::string& text, const std::string& path,
                    const std::vector<std::string>& overrides, const Schema& schema);
  Deck(Deck&&) noexcept;
  Deck& operator=(Deck&&) noexcept;
  ~Deck();

  // Whether the deck has this name before the first dot, be it in the schema or not.
  bool hasName(const std::string& name) const;
  // Whether the deck (or an override) holds the block instance, or the key in it.
  bool hasBlock(const std::string& block) const;
  bool has(const std::string& block, const std::string& key) const;
  // Whether the value, given or default, is there and without fault.
  bool isGood(const std::string& block, const std::string& key) const;
  // Names of a `named` block in the order of the deck: names("material") = {"brick", ...}.
  std::vector<std::string> names(const std::string& block) const;
  // Number of tables of a `repeated` block.
  int count(const std::string& block) const;

  bool boolean(const std::string& block, const std::string& key) const;
  std::int64_t integer(const std::string& block, const std::string& key) const;
  double real(const std::string& block, const std::string& key) const;
  std::string text(const std::string& block, const std::string& key) const; // words too
  std::vector<std::int64_t> integers(const std::string& block, const std::string& key) const;
  std::vector<double> reals(const std::string& block, const std::string& key) const;
  std::vector<std::string> texts(const std::string& block, const std::string& key) const;

  // Adds a fault found by the caller, at the key's line, or at the block's with key = "". `found`
  // and `expected` complete the sentences "found ..." and "expected ...".
  void complain(const std::string& block, const std::string& key, const std::string& found,
                const std::string& expected);
  // Adds a warning, at the same places.
  void warn(const std::string& block, const std::string& key, const std::string& text);
  // Place of a block, for a message: `a.toml:12`, or the --set that gave it, or its `key` if any.
  std::string placeOf(const std::string& block, const std::string& key = "") const;
  // Replaces a text, such as a relative path by the absolute path, also in resolved().
  void assignText(const std::string& block, const std::string& key, const std::string& value);
  // Gives a key that the deck leaves out a value that depends on other keys, also in resolved().
  void assignReal(const std::string& block, const std::string& key, double value);
  // Number of faults so far.
  int faults() const;
  // Throws InputError with all faults, sorted by line, if there are any. Not collective.
  void finish() const;
  // Collective: the same, as rank 0 finds it, on every rank.
  void finish(MPI_Comm comm) const;
  // All faults as finish() throws them; "" if there are none.
  std::string message() const;
  // One line for each former name in the deck or the overrides, and for each warn(), in the order
  // of the faults.
  std::vector<std::string> warnings() const;

  // The deck with all defaults filled in, as TOML that resolves to itself. Needs a deck without
  // faults.
  std::string resolved() const;
  const std::string& path() const;

private:
  struct Contents;
  explicit Deck(std::unique_ptr<Contents> contents);
  std::unique_ptr<Contents> _contents;
};

} // namespace brickwall::io
