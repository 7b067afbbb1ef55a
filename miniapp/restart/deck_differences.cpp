#include "miniapp/restart/deck_differences.hpp"

#include <algorithm>
#include <map>
#include <sstream>
#include <vector>

namespace brickwall::miniapp {

namespace {

struct Entry {
  std::string key; // "block.key"; of the blocks of a list as in --set, "block[0].key"
  std::string value; // with its comment
};

// The keys that results depend on.
std::vector<Entry> entriesOf(const std::string& deck) {
  std::vector<Entry> entries;
  std::map<std::string, int> num_listed; // blocks of each list
  std::istringstream lines(deck);
  std::string line, name, block;
  while (std::getline(lines, line)) {
    if (line.empty() || line[0] == '#')
      continue;
    if (line[0] == '[') {
      name = line.substr(line.find_first_not_of('['));
      name = name.substr(0, name.find(']'));
      const bool is_listed = line[1] == '[';
      block = name + (is_listed ? "[" + std::to_string(num_listed[name]++) + "]." : ".");
      continue;
    }
    const std::size_t blank = std::min(line.find(' '), line.size());
    const std::string key = block + line.substr(0, blank);
    if (name != "output.checkpoint" && name != "partition" && name != "skip" && key != "title" &&
        key != "units" && key != "time.steps" && key != "limits.wall_time" && key != "mesh.file" &&
        key != "search.decomposition")
      entries.push_back({key, line.substr(blank)});
  }
  return entries;
}

const Entry* find(const std::vector<Entry>& entries, const std::string& key) {
  const auto at = std::find_if(entries.begin(), entries.end(),
                               [&](const Entry& entry) { return entry.key == key; });
  return at == entries.end() ? nullptr : &*at;
}

} // namespace

std::string deckDifference(const std::string& of_checkpoint, const std::string& of_run) {
  const auto before = entriesOf(of_checkpoint), now = entriesOf(of_run);
  for (const Entry& was : before) {
    const Entry* const is = find(now, was.key);
    if (is == nullptr)
      return "it was written with " + was.key + was.value + ", and the deck has no " + was.key;
    if (is->value != was.value)
      return "it was written with " + was.key + was.value + ", and the deck has " + is->key +
             is->value + (is->key == "time.end" ? "; --extend-to moves the end" : "");
  }
  for (const Entry& is : now)
    if (find(before, is.key) == nullptr)
      return "it was written without " + is.key + ", and the deck has " + is.key + is.value;
  return "";
}

} // namespace brickwall::miniapp
