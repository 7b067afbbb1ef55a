#include "io/deck/deck_overrides.hpp"

#include "io/deck/deck_renames.hpp"

#include <algorithm>
#include <optional>

namespace brickwall::io {
namespace {

std::string withoutOuterBlanks(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  const std::size_t end = text.find_last_not_of(" \t");
  return begin == std::string::npos ? "" : text.substr(begin, end + 1 - begin);
}

// "load.pressure[0].peak" and "load.pressure.0.peak" -> {"load", "pressure", "0", "peak"}; none if
// a name is empty.
std::optional<std::vector<std::string>> splitPath(const std::string& path) {
  std::vector<std::string> names(1);
  bool after_index = false; // only '.' or '[' may follow a ']'
  for (std::size_t i = 0; i < path.size(); ++i) {
    const char c = path[i];
    if (c == '.' || c == '[') {
      if (names.back().empty())
        return std::nullopt;
      names.emplace_back();
      after_index = false;
      if (c == '[') {
        const std::size_t close = path.find(']', i);
        if (close == std::string::npos)
          return std::nullopt;
        names.back() = path.substr(i + 1, close - i - 1);
        i = close;
        after_index = true;
      }
    } else if (after_index || c == ']') {
      return std::nullopt;
    } else {
      names.back() += c;
    }
  }
  if (names.back().empty())
    return std::nullopt;
  return names;
}

std::optional<std::size_t> asIndex(const std::string& name) {
  if (name.empty() || name.size() > 6 || name.find_first_not_of("0123456789") != std::string::npos)
    return std::nullopt;
  return std::stoul(name);
}

const KeyRule* findRule(const Schema& schema, const std::vector<std::string>& path) {
  for (const BlockRule& block : schema) {
    const std::vector<std::string> names = splitDots(block.name);
    const bool has_instance = block.kind == BlockKind::named || block.kind == BlockKind::repeated;
    if (path.size() != names.size() + (has_instance ? 2 : 1) ||
        !std::equal(names.begin(), names.end(), path.begin()))
      continue;
    for (const KeyRule& key : block.keys)
      if (key.name == path.back())
        return &key;
  }
  return nullptr;
}

bool isRepeated(const Schema& schema, const std::vector<std::string>& path, std::size_t depth) {
  std::string name;
  for (std::size_t i = 0; i < depth; ++i)
    name += (i ? "." : "") + path[i];
  return std::any_of(schema.begin(), schema.end(), [&](const BlockRule& block) {
    return block.kind == BlockKind::repeated && block.name == name;
  });
}

void setPosition(TomlNode& node, int option) {
  node.at = node.key_at = Position{1, 1, 1, option};
  for (TomlNode& entry : node.entries)
    setPosition(entry, option);
  for (auto& member : node.members)
    setPosition(member.second, option);
}

// Whether the bytes are sequences of UTF-8, by their lengths.
bool isUtf8(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto lead = static_cast<unsigned char>(text[i]);
    if (lead >= 0x80 && (lead < 0xc2 || lead > 0xf4))
      return false;
    const int following = (lead >= 0xc2) + (lead >= 0xe0) + (lead >= 0xf0);
    for (int k = 0; k < following; ++k)
      if (++i == text.size() || (static_cast<unsigned char>(text[i]) & 0xc0) != 0x80)
        return false;
  }
  return true;
}

TomlNode emptyNode(TomlNode::Kind kind, int option) {
  TomlNode node;
  node.kind = kind;
  setPosition(node, option);
  return node;
}

} // namespace

TomlNode parseLooseValue(const std::string& spelling, const KeyRule* rule) {
  const bool wants_text = rule && rule->length == KeyRule::scalar &&
                          (rule->type == ValueType::text || rule->type == ValueType::word);
  const std::size_t first = spelling.find_first_not_of(" \t");
  const bool is_quoted =
      first != std::string::npos && (spelling[first] == '"' || spelling[first] == '\'');
  if (!wants_text || is_quoted) {
    try {
      return parseTomlValue(spelling);
    } catch (const TomlSyntaxError&) {
      if (first != std::string::npos && (spelling[first] == '[' || spelling[first] == '{' ||
                                         hasNumberWithoutLeadingDigit(spelling)))
        throw;
      // a bare word: the value of a text, otherwise of the wrong type, which the checker reports
    }
  }
  TomlNode node;
  node.kind = TomlNode::Kind::text;
  node.text = spelling;
  return node;
}

void applyOverride(const std::string& text, int index, const Schema& schema, TomlNode& root,
                   DeckFaults& faults) {
  const Position here{1, 1, 1, index};
  if (!isUtf8(text)) {
    faults.add(here, "", "bytes that are not UTF-8", "UTF-8, as in a deck");
    return;
  }
  const std::size_t equals = text.find('=');
  auto path = equals == std::string::npos ? std::nullopt
                                          : splitPath(withoutOuterBlanks(text.substr(0, equals)));
  if (!path) {
    faults.add(here, "", "\"" + text + "\"", "block.key=value, such as time.safety=0.9");
    return;
  }
  renameInPath(schema, here, *path, faults);
  TomlNode value;
  try {
    value = parseLooseValue(withoutOuterBlanks(text.substr(equals + 1)), findRule(schema, *path));
    setPosition(value, index);
  } catch (const TomlSyntaxError& error) {
    faults.add(here, "", error.what(), error.expected);
    return;
  }
  TomlNode* node = &root;
  for (std::size_t i = 0; i < path->size(); ++i) {
    const std::string& name = (*path)[i];
    const bool last = i + 1 == path->size();
    if (node->kind == TomlNode::Kind::list) {
      const auto entry = asIndex(name);
      const std::size_t size = node->entries.size();
      if (!entry || *entry > size || (last && *entry == size)) {
        faults.add(here, "", "index \"" + name + "\"",
                   "a whole number up to " + std::to_string(last && size > 0 ? size - 1 : size));
        return;
      }
      if (*entry == size) // one more table
        node->entries.push_back(emptyNode(TomlNode::Kind::table, index));
      node = &node->entries[*entry];
    } else if (node->kind == TomlNode::Kind::table) {
      if (!node->member(name)) {
        const bool list = !last && isRepeated(schema, *path, i + 1);
        node->members.emplace_back(
            name, emptyNode(list ? TomlNode::Kind::list : TomlNode::Kind::table, index));
      }
      node = node->member(name);
    } else {
      faults.add(here, "", "\"" + name + "\" below " + node->describe(), "block.key=value");
      return;
    }
  }
  *node = std::move(value);
}

} // namespace brickwall::io
