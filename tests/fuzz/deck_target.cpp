// The deck reader: TOML text to a configuration, as `brickwall check` reads it. Lines "#--set
// KEY=VALUE" of the text are overrides too.
//
// A deck that is accepted resolves to a deck that resolves to itself; every value of the deck
// stands in the resolved one, so that none is passed over; and every value there is within the
// bounds of its key.
#include "tests/fuzz/fuzz_target.hpp"

#include "contact/base/error.hpp"
#include "miniapp/deck/config.hpp"

#include <toml.hpp>

#include <map>
#include <sstream>

namespace {

using namespace brickwall;
using fuzz::demand;

std::vector<std::string> overridesIn(const std::string& text) {
  const std::string mark = "#--set ";
  std::vector<std::string> overrides;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.compare(0, mark.size(), mark) == 0)
      overrides.push_back(line.substr(mark.size()));
  return overrides;
}

// Values by their path, entries of lists by their index; numbers as doubles.
using Leaves = std::map<std::string, std::string>;

void addLeaves(const toml::value& value, const std::string& path, Leaves& leaves) {
  if (value.is_table()) {
    for (const auto& [key, member] : value.as_table())
      addLeaves(member, path + "/" + key, leaves);
  } else if (value.is_array()) {
    int index = 0;
    for (const toml::value& entry : value.as_array())
      addLeaves(entry, path + "/" + std::to_string(index++), leaves);
  } else if (value.is_string()) {
    leaves[path] = "text " + value.as_string().str;
  } else if (value.is_boolean()) {
    leaves[path] = value.as_boolean() ? "true" : "false";
  } else if (value.is_integer() || value.is_floating()) {
    const double number =
        value.is_integer() ? static_cast<double>(value.as_integer()) : value.as_floating();
    char digits[64];
    std::snprintf(digits, sizeof digits, "%.17g", number == 0 ? 0.0 : number); // no -0
    leaves[path] = digits;
  } else {
    leaves[path] = "a date";
  }
}

Leaves leavesOf(std::string text) {
  if (text.compare(0, 3, "\xEF\xBB\xBF") == 0)
    text.erase(0, 3);
  std::istringstream stream(text);
  Leaves leaves;
  addLeaves(toml::parse(stream, "deck"), "", leaves);
  return leaves;
}

void demandWithin(const io::KeyRule& rule, const std::string& path, const std::string& value) {
  if (rule.type != io::ValueType::integer && rule.type != io::ValueType::real)
    return;
  const double number = std::strtod(value.c_str(), nullptr);
  demand(number > rule.lower || (number == rule.lower && !rule.lower_is_open), path + " >=");
  demand(number < rule.upper || (number == rule.upper && !rule.upper_is_open), path + " <=");
}

// The names of a path without indices, and without the name of a block such as [material.NAME].
bool isOf(const std::string& path, const io::BlockRule& block, const io::KeyRule& key) {
  std::vector<std::string> names;
  std::istringstream parts(path);
  for (std::string name; std::getline(parts, name, '/');)
    if (name.find_first_not_of("0123456789") != std::string::npos)
      names.push_back(name);
  if (block.kind == io::BlockKind::named && names.size() > 2)
    names.erase(names.begin() + 1);
  std::string joined;
  for (const std::string& name : names)
    joined += (joined.empty() ? "" : ".") + name;
  return joined == (block.name.empty() ? "" : block.name + ".") + key.name;
}

void demandInRange(const Leaves& leaves) {
  for (const auto& [path, value] : leaves)
    for (const io::BlockRule& block : miniapp::deckSchema())
      for (const io::KeyRule& key : block.keys)
        if (isOf(path, block, key))
          demandWithin(key, path, value);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const std::vector<std::string> overrides = overridesIn(text);
  miniapp::Config config;
  try {
    config = miniapp::parseConfig(text, "/decks/fuzz.toml", overrides);
  } catch (const InputError& error) {
    fuzz::demandMessage(error.what());
    return 0;
  }
  const std::string& resolved = config.resolved_deck;
  try {
    const miniapp::Config again = miniapp::parseConfig(resolved, "/elsewhere/fuzz.toml");
    demand(again.resolved_deck == resolved, "the resolved deck resolves to itself:\n" + resolved +
                                                "\nresolves to:\n" + again.resolved_deck);
    for (const std::string& warning : again.warnings)
      demand(warning.find("former name") == std::string::npos, "the resolved deck: " + warning);
  } catch (const InputError& error) {
    demand(false, "the resolved deck is accepted:\n" + resolved + error.what());
  }
  const Leaves found = leavesOf(resolved);
  demandInRange(found);
  if (!overrides.empty() || !config.warnings.empty()) // which change values or names
    return 0;
  for (const auto& [path, value] : leavesOf(text)) {
    const auto kept = found.find(path);
    demand(kept != found.end(), path + " of the deck stands in the resolved deck:\n" + resolved);
    demand(kept->second == value || path == "/mesh/file", path + " keeps its value " + value);
  }
  return 0;
}
