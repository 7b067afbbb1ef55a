#include "io/deck/deck_spelling.hpp"

#include <algorithm>
#include <charconv>

namespace brickwall::io {
namespace {

std::string spellText(const std::string& value) {
  static const char* hex = "0123456789ABCDEF";
  std::string out = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\')
      out += std::string("\\") + c;
    else if (static_cast<unsigned char>(c) < 32 || c == 127)
      out += std::string("\\u00") + hex[(c >> 4) & 15] + hex[c & 15];
    else
      out += c;
  }
  return out + '"';
}

std::string spellName(const std::string& name) {
  const bool bare = !name.empty() && name.find_first_not_of("abcdefghijklmnopqrstuvwxyz"
                                                            "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                                            "0123456789_-") == std::string::npos;
  return bare ? name : spellText(name);
}

std::string spellEntry(const DeckValue::Entry& entry, ValueType type) {
  switch (type) {
  case ValueType::boolean:
    return entry.boolean ? "true" : "false";
  case ValueType::integer:
    return std::to_string(entry.integer);
  case ValueType::real:
    return spellReal(entry.real);
  case ValueType::word:
  case ValueType::text:
    break;
  }
  return spellText(entry.text);
}

std::string spellValue(const DeckValue& value) {
  const KeyRule& rule = *value.rule;
  if (rule.length == KeyRule::scalar)
    return spellEntry(value.entries.front(), rule.type);
  std::string out = "[";
  for (std::size_t i = 0; i < value.entries.size(); ++i)
    out += (i ? ", " : "") + spellEntry(value.entries[i], rule.type);
  return out + "]";
}

std::string spellHeader(const DeckBlock& block) {
  return block.rule->kind == BlockKind::top
             ? ""
             : "\n" + headerOf(*block.rule, spellName(block.name)) + "\n";
}

bool anyRequired(const BlockRule& rule) {
  return std::any_of(rule.keys.begin(), rule.keys.end(),
                     [](const KeyRule& key) { return key.required; });
}

} // namespace

std::string headerOf(const BlockRule& rule, const std::string& name) {
  if (rule.kind == BlockKind::named)
    return "[" + rule.name + "." + name + "]";
  return rule.kind == BlockKind::repeated ? "[[" + rule.name + "]]" : "[" + rule.name + "]";
}

std::string spellReal(double value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof(digits), value).ptr;
  std::string out(digits, end);
  if (out.find_first_of(".e") == std::string::npos)
    out += ".0";
  return out;
}

std::string spellBlock(const DeckBlock& block) {
  if (!block.is_given && anyRequired(*block.rule))
    return ""; // such as [mesh] beside [wall]
  std::string keys;
  for (const DeckValue& value : block.values)
    if (value.is_good)
      keys += value.rule->name + " = " + spellValue(value) +
              (value.rule->unit.empty() ? "" : " # " + value.rule->unit) + "\n";
  return block.is_given || !keys.empty() ? spellHeader(block) + keys : "";
}

} // namespace brickwall::io
