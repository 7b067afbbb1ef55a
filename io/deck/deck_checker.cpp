// See deck_checker.hpp. The tree is walked twice: once to find names that the schema lacks, once by
// the schema to read the values.
#include "io/deck/deck_checker.hpp"

#include "io/deck/deck_overrides.hpp"
#include "io/deck/deck_renames.hpp"
#include "io/deck/deck_spelling.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace brickwall::io {
namespace {

using Kind = TomlNode::Kind;

const BlockRule* findBlock(const Schema& schema, const std::string& name) {
  for (const BlockRule& block : schema)
    if (block.name == name && block.kind != BlockKind::top)
      return &block;
  return nullptr;
}

const BlockRule* topBlock(const Schema& schema) {
  for (const BlockRule& block : schema)
    if (block.kind == BlockKind::top)
      return &block;
  return nullptr;
}

const KeyRule* findKey(const BlockRule* block, const std::string& name) {
  if (block)
    for (const KeyRule& key : block->keys)
      if (key.name == name)
        return &key;
  return nullptr;
}

std::vector<std::string> keyNames(const BlockRule* block) {
  std::vector<std::string> names;
  if (block)
    for (const KeyRule& key : block->keys)
      names.push_back(key.name);
  return names;
}

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i)
    out += (i == 0 ? "" : ", ") + names[i];
  return out;
}

std::string joined(const std::string& prefix, const std::string& name) {
  return prefix.empty() ? name : prefix + "." + name;
}

bool isTables(const TomlNode& node) {
  return node.kind == Kind::list && !node.entries.empty() &&
         node.entries.front().kind == Kind::table;
}

// Finds the names that the schema lacks.
class UnknownNames {
public:
  UnknownNames(const Schema& schema, DeckFaults& faults) : _schema(schema), _faults(faults) {}

  // A table that holds blocks, or the whole deck with prefix "".
  void visitGroup(const TomlNode& table, const std::string& prefix) {
    for (const auto& [name, node] : table.members) {
      const std::string path = joined(prefix, name);
      const BlockRule* block = findBlock(_schema, path);
      if (prefix.empty() && findKey(topBlock(_schema), name))
        continue;
      if (block)
        visitBlock(node, *block);
      else if (!isGroup(path))
        unknownBlock(node, prefix, name);
      else if (node.kind == Kind::table)
        visitGroup(node, path);
      else
        _faults.add(node.key_at, path, node.describe(), "tables [" + path + ".<name>]");
    }
  }

private:
  bool isGroup(const std::string& path) const {
    const std::string begin = path + ".";
    return std::any_of(_schema.begin(), _schema.end(), [&](const BlockRule& block) {
      return block.name.compare(0, begin.size(), begin) == 0;
    });
  }

  void visitBlock(const TomlNode& node, const BlockRule& block) {
    const std::string plain = "[" + block.name + "]";
    if (block.kind == BlockKind::single) {
      if (node.kind == Kind::table)
        visitKeys(node, block, plain);
      else
        _faults.add(node.key_at, block.name,
                    isTables(node) ? "an array of tables [" + plain + "]" : node.describe(),
                    "one table " + plain + withKeys(block));
    } else if (block.kind == BlockKind::named) {
      visitNamed(node, block);
    } else if (node.kind == Kind::list) {
      for (const TomlNode& entry : node.entries)
        if (entry.kind == Kind::table)
          visitKeys(entry, block, "[" + plain + "]");
        else
          _faults.add(entry.at, block.name, entry.describe(), "tables [" + plain + "]");
    } else {
      _faults.add(node.key_at, block.name,
                  node.kind == Kind::table ? "a single table " + plain : node.describe(),
                  "an array of tables: [" + plain + "]" + withKeys(block));
    }
  }

  void visitNamed(const TomlNode& node, const BlockRule& block) {
    const std::string header = headerOf(block);
    if (node.kind != Kind::table) {
      _faults.add(node.key_at, block.name, node.describe(), "tables " + header);
      return;
    }
    for (const auto& [name, member] : node.members)
      if (member.kind == Kind::table)
        visitKeys(member, block, "[" + block.name + "." + name + "]");
      else
        _faults.add(member.key_at, "[" + block.name + "] " + name,
                    isTables(member) ? "an array of tables [[" + block.name + "." + name + "]]"
                                     : member.describe(),
                    "a table " + header + withKeys(block));
  }

  void visitKeys(const TomlNode& table, const BlockRule& block, const std::string& header) {
    for (const auto& [name, node] : table.members) {
      if (findKey(&block, name))
        continue;
      const BlockRule* inner =
          block.kind == BlockKind::single ? findBlock(_schema, joined(block.name, name)) : nullptr;
      if (inner)
        visitBlock(node, *inner);
      else
        unknownKey(node, block, header, name);
    }
  }

  // Names that a block may contain: its keys, then the tables inside it.
  std::vector<std::string> namesIn(const BlockRule& block) const {
    std::vector<std::string> names = keyNames(&block);
    const std::string begin = block.name + ".";
    for (const BlockRule& inner : _schema)
      if (block.kind == BlockKind::single && inner.name.compare(0, begin.size(), begin) == 0)
        names.push_back(inner.name.substr(begin.size()));
    return names;
  }

  std::string withKeys(const BlockRule& block) const {
    return ", whose keys are " + listed(namesIn(block));
  }

  void unknownKey(const TomlNode& node, const BlockRule& block, const std::string& header,
                  const std::string& name) {
    const std::vector<std::string> known = namesIn(block);
    std::string expected = "one of " + listed(known);
    for (const BlockRule& other : _schema)
      if (&other != &block && findKey(&other, name)) {
        expected += " (" + name + " is a key of " +
                    (other.name.empty() ? "the top of the deck" : "[" + other.name + "]") + ")";
        break;
      }
    _faults.add(node.key_at, header, "unknown key \"" + name + "\"", expected,
                nearestName(name, known));
  }

  void unknownBlock(const TomlNode& node, const std::string& prefix, const std::string& name) {
    const std::string begin = prefix.empty() ? "" : prefix + ".";
    std::vector<std::string> known;
    for (const BlockRule& block : _schema)
      if (block.kind != BlockKind::top && block.name.compare(0, begin.size(), begin) == 0)
        known.push_back(block.name);
    if (prefix.empty())
      for (const std::string& key : keyNames(topBlock(_schema)))
        known.push_back(key);
    // The last name alone may also mean a block: [fixed] for [[boundary.fixed]], [[load.gravity]]
    // for [gravity].
    std::string nearest = nearestName(joined(prefix, name), known);
    for (const BlockRule& block : _schema)
      if (nearest.empty() && block.kind != BlockKind::top &&
          block.name.substr(block.name.rfind('.') + 1) == name)
        nearest = block.name;
    if (const BlockRule* block = findBlock(_schema, nearest))
      nearest = headerOf(*block);
    const bool is_block = node.kind == Kind::table || isTables(node);
    _faults.add(node.key_at, "",
                std::string("unknown ") + (is_block ? "block" : "key") + " \"" +
                    joined(prefix, name) + "\"",
                "one of " + listed(known), nearest);
  }

  const Schema& _schema;
  DeckFaults& _faults;
};

// Reads the values of one table by its rules.
class ValueReader {
public:
  explicit ValueReader(DeckFaults& faults) : _faults(faults) {}

  // `node` null: the block is not given, all values are defaults.
  void readBlock(const TomlNode* node, DeckBlock& block) {
    for (const KeyRule& rule : block.rule->keys) {
      DeckValue value;
      value.rule = &rule;
      value.at = block.at;
      const TomlNode* member = node ? node->member(rule.name) : nullptr;
      if (member) {
        value.is_given = true;
        value.at = member->at;
        _subject = block.header + (block.header.empty() ? "" : " ") + rule.name;
        value.is_good = readValue(*member, rule, value.entries);
      } else if (rule.required && block.is_given) {
        _faults.add(block.at, block.header, "no key \"" + rule.name + "\"",
                    rule.name + " = " + describeValue(rule) +
                        (rule.unit.empty() ? "" : ", in " + rule.unit));
      } else if (!rule.fallback.empty()) {
        auto [at, is_new] = _defaults.try_emplace(&rule);
        if (is_new)
          at->second = parseLooseValue(rule.fallback, &rule);
        _subject = "default of " + rule.name;
        value.is_good = readValue(at->second, rule, value.entries);
      }
      block.values.push_back(std::move(value));
    }
  }

private:
  bool readValue(const TomlNode& node, const KeyRule& rule,
                 std::vector<DeckValue::Entry>& entries) {
    if (rule.length == KeyRule::scalar) {
      entries.emplace_back();
      return readEntry(node, rule, entries.back());
    }
    const bool any = rule.length == KeyRule::any_length;
    if (node.kind != Kind::list ||
        (any ? node.entries.empty() : node.entries.size() != static_cast<std::size_t>(rule.length)))
      return wrong(node, rule);
    bool good = true;
    for (const TomlNode& entry : node.entries) {
      entries.emplace_back();
      good = readEntry(entry, rule, entries.back()) && good;
    }
    return good;
  }

  bool readEntry(const TomlNode& node, const KeyRule& rule, DeckValue::Entry& entry) {
    switch (rule.type) {
    case ValueType::boolean:
      entry.boolean = node.boolean;
      return node.kind == Kind::boolean || wrong(node, rule);
    case ValueType::integer:
      if (node.kind != Kind::integer)
        return wrong(node, rule);
      if (node.overflows)
        return wrong(node, rule, node.describe() + ", beyond 64 bits");
      entry.integer = node.integer;
      return isWithin(static_cast<double>(node.integer), rule) || wrong(node, rule);
    case ValueType::real:
      return readReal(node, rule, entry);
    case ValueType::word:
      entry.text = node.text;
      if (node.kind != Kind::text)
        return wrong(node, rule);
      if (std::find(rule.words.begin(), rule.words.end(), node.text) == rule.words.end())
        return wrong(node, rule, node.describe(), nearestName(node.text, rule.words));
      return true;
    case ValueType::text:
      break;
    }
    entry.text = node.text;
    return node.kind == Kind::text || wrong(node, rule);
  }

  bool readReal(const TomlNode& node, const KeyRule& rule, DeckValue::Entry& entry) {
    if (node.kind != Kind::real && node.kind != Kind::integer)
      return wrong(node, rule);
    if (node.overflows)
      return wrong(node, rule, node.describe() + ", too large");
    const double value = node.kind == Kind::real ? node.real : static_cast<double>(node.integer);
    if (!std::isfinite(value) || !isWithin(value, rule))
      return wrong(node, rule);
    entry.real = value;
    return true;
  }

  static bool isWithin(double value, const KeyRule& rule) {
    return (rule.lower_is_open ? value > rule.lower : value >= rule.lower) &&
           (rule.upper_is_open ? value < rule.upper : value <= rule.upper);
  }

  bool wrong(const TomlNode& node, const KeyRule& rule, const std::string& found,
             const std::string& nearest = "") {
    _faults.add(node.at, _subject, found,
                describeValue(rule) + (rule.unit.empty() ? "" : ", in " + rule.unit), nearest);
    return false;
  }
  bool wrong(const TomlNode& node, const KeyRule& rule) {
    return wrong(node, rule, node.describe());
  }

  DeckFaults& _faults;
  std::string _subject;
  std::unordered_map<const KeyRule*, TomlNode> _defaults; // parsed once, for thousands of blocks
};

const TomlNode* findNode(const TomlNode& root, const std::string& path) {
  const TomlNode* node = &root;
  for (const std::string& name : splitDots(path))
    node = node && node->kind == Kind::table ? node->member(name) : nullptr;
  return node;
}

} // namespace

std::vector<DeckBlock> checkDeck(const TomlNode& root, const Schema& schema, DeckFaults& faults) {
  UnknownNames(schema, faults).visitGroup(root, "");
  ValueReader reader(faults);
  const Position end{faults.numLines(), 1, 1, -1};
  std::vector<DeckBlock> blocks;
  const auto addBlock = [&](const BlockRule& rule, const std::string& instance,
                            const std::string& header, const TomlNode* node) -> DeckBlock& {
    DeckBlock block;
    block.rule = &rule;
    block.instance = instance;
    block.header = header;
    block.is_given = node != nullptr;
    block.at = node ? node->at : end;
    reader.readBlock(node, block);
    blocks.push_back(std::move(block));
    return blocks.back();
  };
  for (const BlockRule& rule : schema) {
    const TomlNode* node = findNode(root, rule.name);
    if (rule.kind == BlockKind::top || rule.kind == BlockKind::single) {
      const bool is_no_table = node && node->kind != Kind::table; // reported already
      if (is_no_table)
        node = nullptr;
      const std::string header = rule.name.empty() ? "" : "[" + rule.name + "]";
      if (!node && rule.required && !is_no_table)
        faults.add(end, "", "no block " + header, header + "  " + rule.help);
      addBlock(rule, rule.name, header, node);
    } else if (rule.kind == BlockKind::named && node && node->kind == Kind::table) {
      for (const auto& [name, member] : node->members)
        if (member.kind == Kind::table) {
          const std::string instance = rule.name + "." + name;
          addBlock(rule, instance, "[" + instance + "]", &member).name = name;
        }
    } else if (rule.kind == BlockKind::repeated && node && node->kind == Kind::list) {
      int index = 0;
      for (const TomlNode& entry : node->entries)
        if (entry.kind == Kind::table)
          addBlock(rule, rule.name + "[" + std::to_string(index++) + "]", "[[" + rule.name + "]]",
                   &entry);
    }
  }
  return blocks;
}

} // namespace brickwall::io
