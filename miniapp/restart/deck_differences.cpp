#include "miniapp/restart/deck_differences.hpp"

#include <algorithm>
#include <map>
#include <sstream>
#include <utility>
#include <vector>

namespace brickwall::miniapp {

namespace {

// Keys, "block.key" or, of the blocks of a list as in --set, "block[0].key", and their values with
// comments, in the order of the deck.
using Entries = std::vector<std::pair<std::string, std::string>>;

// The keys that results depend on.
Entries entriesOf(const std::string& deck) {
  Entries entries;
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
      entries.emplace_back(key, line.substr(blank));
  }
  return entries;
}

} // namespace

std::string deckDifference(const std::string& of_checkpoint, const std::string& of_run) {
  const Entries before = entriesOf(of_checkpoint), now = entriesOf(of_run);
  const std::map<std::string, std::string> values_before(before.begin(), before.end());
  const std::map<std::string, std::string> values_now(now.begin(), now.end());
  for (const auto& [key, was] : before) {
    const auto is = values_now.find(key);
    if (is == values_now.end())
      return "it was written with " + key + was + ", and the deck has no " + key;
    if (is->second != was)
      return "it was written with " + key + was + ", and the deck has " + key + is->second +
             (key == "time.end" ? "; --extend-to moves the end" : "");
  }
  for (const auto& [key, is] : now)
    if (values_before.count(key) == 0)
      return "it was written without " + key + ", and the deck has " + key + is;
  return "";
}

} // namespace brickwall::miniapp
