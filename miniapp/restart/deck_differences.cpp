#include "miniapp/restart/deck_differences.hpp"

#include <sstream>
#include <vector>

namespace brickwall::miniapp {

namespace {

// "block.key = value" of each key that results depend on.
std::vector<std::string> entriesOf(const std::string& deck) {
  std::vector<std::string> entries;
  std::istringstream lines(deck);
  std::string line, block;
  while (std::getline(lines, line)) {
    if (line.empty() || line[0] == '#')
      continue;
    if (line[0] == '[') {
      block = line.substr(line.find_first_not_of('['));
      block = block.substr(0, block.find(']')) + ".";
      continue;
    }
    const std::string entry = block + line;
    const std::string key = entry.substr(0, entry.find(' '));
    if (block != "output.checkpoint." && block != "partition." && block != "skip." &&
        key != "title" && key != "units" && key != "time.steps" && key != "limits.wall_time" &&
        key != "mesh.file" && key != "search.decomposition")
      entries.push_back(entry);
  }
  return entries;
}

} // namespace

std::string deckDifference(const std::string& of_checkpoint, const std::string& of_run) {
  const auto before = entriesOf(of_checkpoint), now = entriesOf(of_run);
  for (std::size_t i = 0; i < before.size() || i < now.size(); ++i) {
    const std::string was = i < before.size() ? before[i] : "nothing more";
    const std::string is = i < now.size() ? now[i] : "nothing more";
    if (was != is)
      return "it was written with " + was + ", and the deck has " + is +
             (is.compare(0, 8, "time.end") == 0 ? "; --extend-to moves the end" : "");
  }
  return "";
}

} // namespace brickwall::miniapp
