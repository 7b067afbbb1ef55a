// Rules of keys: their construction, their description, and the nearest name.
#include "io/deck/deck.hpp"
#include "io/deck/deck_spelling.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

namespace brickwall::io {

KeyRule& KeyRule::in(const std::string& unit_name) {
  unit = unit_name;
  return *this;
}
KeyRule& KeyRule::mustBeGiven() {
  required = true;
  return optional();
}
KeyRule& KeyRule::optional() {
  fallback.clear();
  return *this;
}
KeyRule& KeyRule::byDefault(const std::string& spelling) {
  fallback = spelling;
  return *this;
}
KeyRule& KeyRule::byDefault(double value) {
  // The shorter of 0.01 and 1e-2: for people, who also read it in `brickwall --keys`.
  char digits[32];
  const auto end =
      std::to_chars(digits, digits + sizeof(digits), value, std::chars_format::scientific).ptr;
  std::string scientific(digits, end);
  const std::size_t zero = scientific.find("e-0");
  if (zero != std::string::npos)
    scientific.erase(zero + 2, 1);
  const std::string plain = spellReal(value);
  return byDefault(!std::isfinite(value)              ? ""
                   : scientific.size() < plain.size() ? scientific
                                                      : plain);
}
KeyRule& KeyRule::formerly(const std::string& former) {
  former_name = former;
  return *this;
}
KeyRule& KeyRule::list(int entries) {
  length = entries;
  return *this;
}
KeyRule& KeyRule::atLeast(double bound) {
  lower = bound;
  lower_is_open = false;
  return *this;
}
KeyRule& KeyRule::above(double bound) {
  lower = bound;
  lower_is_open = true;
  return *this;
}
KeyRule& KeyRule::atMost(double bound) {
  upper = bound;
  upper_is_open = false;
  return *this;
}
KeyRule& KeyRule::below(double bound) {
  upper = bound;
  upper_is_open = true;
  return *this;
}

namespace {

KeyRule rule(const std::string& name, ValueType type, const std::string& unit,
             const std::string& help) {
  KeyRule made;
  made.name = name;
  made.type = type;
  made.unit = unit;
  made.help = help;
  return made;
}

std::string number(double value) {
  std::ostringstream out;
  out.precision(15);
  out << value;
  return out.str();
}

std::string typeName(const KeyRule& rule, bool plural) {
  switch (rule.type) {
  case ValueType::boolean:
    return plural ? "booleans" : "true or false";
  case ValueType::integer:
    return plural ? "integers" : "an integer";
  case ValueType::real:
    return plural ? "finite numbers" : "a finite number";
  case ValueType::word:
    return plural ? "words" : "one";
  case ValueType::text:
    break;
  }
  return plural ? "texts" : "a text";
}

std::string bounds(const KeyRule& rule) {
  std::string out;
  if (rule.lower > -std::numeric_limits<double>::infinity())
    out += (rule.lower_is_open ? " above " : " at least ") + number(rule.lower);
  if (rule.upper < std::numeric_limits<double>::infinity())
    out += std::string(out.empty() ? "" : " and") + (rule.upper_is_open ? " below " : " at most ") +
           number(rule.upper);
  return out;
}

} // namespace

KeyRule boolean(const std::string& name, const std::string& help) {
  return rule(name, ValueType::boolean, "", help);
}
KeyRule integer(const std::string& name, const std::string& help) {
  return rule(name, ValueType::integer, "", help);
}
KeyRule real(const std::string& name, const std::string& unit, const std::string& help) {
  return rule(name, ValueType::real, unit, help);
}
KeyRule word(const std::string& name, std::vector<std::string> words, const std::string& help) {
  KeyRule made = rule(name, ValueType::word, "", help);
  made.words = std::move(words);
  return made;
}
KeyRule text(const std::string& name, const std::string& help) {
  return rule(name, ValueType::text, "", help);
}

std::string describeValue(const KeyRule& rule) {
  std::string out;
  if (rule.length == KeyRule::scalar)
    out = typeName(rule, false);
  else if (rule.length == KeyRule::any_length)
    out = "a list of one or more " + typeName(rule, true);
  else
    out = "a list of " + std::to_string(rule.length) + " " + typeName(rule, true);
  if (rule.type == ValueType::word) {
    out += " of";
    for (std::size_t i = 0; i < rule.words.size(); ++i)
      out += std::string(i ? ", " : " ") + '"' + rule.words[i] + '"';
  }
  const std::string range = bounds(rule);
  if (!range.empty())
    out += (rule.length == KeyRule::scalar ? "" : " each") + range;
  return out;
}

std::string describe(const Schema& schema) {
  std::ostringstream out;
  for (const BlockRule& block : schema) {
    out << (block.kind == BlockKind::top ? "(top of the deck)" : headerOf(block)) << "  "
        << block.help << "\n";
    for (const KeyRule& key : block.keys) {
      out << "  " << key.name;
      if (key.name.size() < 20)
        out << std::string(20 - key.name.size(), ' ');
      out << " " << key.help << ": " << describeValue(key);
      if (!key.unit.empty())
        out << ", " << key.unit;
      out << (key.required           ? "; required"
              : key.fallback.empty() ? "; optional"
                                     : "; default " + key.fallback)
          << "\n";
    }
  }
  return out.str();
}

std::string nearestName(const std::string& name, const std::vector<std::string>& candidates) {
  std::string nearest;
  std::size_t best = std::max<std::size_t>(1, std::min<std::size_t>(name.size(), 40) / 2) + 1;
  for (const std::string& candidate : candidates) {
    // Edit distance (Levenshtein) with one row; a swap of neighbours counts as two.
    std::vector<std::size_t> row(candidate.size() + 1);
    for (std::size_t j = 0; j < row.size(); ++j)
      row[j] = j;
    // Longer names are near no other.
    const std::size_t length = std::min<std::size_t>(name.size(), 100);
    for (std::size_t i = 0; i < length; ++i) {
      std::size_t diagonal = row[0];
      row[0] = i + 1;
      for (std::size_t j = 0; j < candidate.size(); ++j) {
        const std::size_t replaced = diagonal + (name[i] == candidate[j] ? 0 : 1);
        diagonal = row[j + 1];
        row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
      }
    }
    if (row.back() < best && name.size() <= 100) {
      best = row.back();
      nearest = candidate;
    }
  }
  return nearest;
}

} // namespace brickwall::io
