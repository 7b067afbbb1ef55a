#include "io/deck/deck_renames.hpp"

#include <algorithm>

namespace brickwall::io {
namespace {

using Kind = TomlNode::Kind;

std::string renamed(const std::string& former, const std::string& present) {
  return former + " is the former name of " + present + " and will be refused by the next release";
}

std::string headerNamed(const BlockRule& block, const std::string& name) {
  return block.kind == BlockKind::named ? "[" + name + ".<name>]" : "[" + name + "]";
}

// "[spare]"
std::string formerHeaderOf(const BlockRule& block) {
  const std::size_t last = block.name.rfind('.');
  const std::string group = last == std::string::npos ? "" : block.name.substr(0, last + 1);
  return headerNamed(block, group + block.former_name);
}

void renameMember(TomlNode& table, const std::string& former, const std::string& present,
                  const std::string& subject, const std::string& warning, DeckFaults& faults) {
  const auto found = std::find_if(table.members.begin(), table.members.end(),
                                  [&](const auto& member) { return member.first == former; });
  if (former.empty() || found == table.members.end())
    return;
  if (table.member(present)) {
    faults.add(found->second.key_at, subject,
               "\"" + former + "\" beside \"" + present + "\", whose former name it is",
               "\"" + present + "\" alone");
    table.members.erase(found);
    return;
  }
  found->first = present;
  faults.warn(found->second.key_at, warning);
}

void renameWord(const KeyRule& key, const std::string& subject, TomlNode& node,
                DeckFaults& faults) {
  if (node.kind == Kind::list)
    for (TomlNode& entry : node.entries)
      renameWord(key, subject, entry, faults);
  if (node.kind != Kind::text)
    return;
  for (const auto& [former, present] : key.former_words)
    if (node.text == former) {
      faults.warn(node.at,
                  subject + key.name + ": " + renamed("\"" + former + "\"", "\"" + present + "\""));
      node.text = present;
      return;
    }
}

void renameKeys(const BlockRule& block, TomlNode& table, DeckFaults& faults) {
  if (table.kind != Kind::table)
    return;
  const std::string header = block.name.empty() ? "" : headerNamed(block, block.name);
  const std::string subject = header.empty() ? "" : header + " ";
  for (const KeyRule& key : block.keys) {
    renameMember(table, key.former_name, key.name, header,
                 subject + renamed(key.former_name, key.name), faults);
    if (TomlNode* value = key.former_words.empty() ? nullptr : table.member(key.name))
      renameWord(key, subject, *value, faults);
  }
}

} // namespace

std::vector<std::string> splitDots(const std::string& name) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin < name.size();) {
    const std::size_t end = std::min(name.find('.', begin), name.size());
    parts.push_back(name.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

void renameInTree(const Schema& schema, TomlNode& root, DeckFaults& faults) {
  for (const BlockRule& block : schema) {
    std::vector<std::string> names = splitDots(block.name);
    if (names.empty()) {
      renameKeys(block, root, faults);
      continue;
    }
    const std::string last = names.back();
    names.pop_back();
    TomlNode* group = &root;
    for (const std::string& name : names)
      group = group && group->kind == Kind::table ? group->member(name) : nullptr;
    if (!group || group->kind != Kind::table)
      continue;
    renameMember(*group, block.former_name, last, "",
                 renamed(formerHeaderOf(block), headerNamed(block, block.name)), faults);
    TomlNode* node = group->member(last);
    if (!node)
      continue;
    if (block.kind == BlockKind::named)
      for (auto& member : node->members)
        renameKeys(block, member.second, faults);
    else if (block.kind == BlockKind::repeated)
      for (TomlNode& entry : node->entries)
        renameKeys(block, entry, faults);
    else
      renameKeys(block, *node, faults);
  }
}

void renameInPath(const Schema& schema, const Position& here, std::vector<std::string>& path,
                  DeckFaults& faults) {
  for (const BlockRule& block : schema) {
    const std::vector<std::string> names = splitDots(block.name);
    if (path.size() < names.size())
      continue;
    if (!block.former_name.empty() && path[names.size() - 1] == block.former_name &&
        std::equal(names.begin(), names.end() - 1, path.begin())) {
      path[names.size() - 1] = names.back();
      faults.warn(here, renamed(formerHeaderOf(block), headerNamed(block, block.name)));
    }
    const bool has_instance = block.kind == BlockKind::named || block.kind == BlockKind::repeated;
    const std::size_t at = names.size() + (has_instance ? 1 : 0);
    if (path.size() <= at || !std::equal(names.begin(), names.end(), path.begin()))
      continue;
    for (const KeyRule& key : block.keys)
      if (!key.former_name.empty() && path[at] == key.former_name) {
        path[at] = key.name;
        faults.warn(here,
                    headerNamed(block, block.name) + " " + renamed(key.former_name, key.name));
      }
  }
}

} // namespace brickwall::io
