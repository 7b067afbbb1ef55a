// The command line: one argument a line. What is accepted is accepted again when it is written in
// full, with the same meaning.
#include "tests/fuzz/fuzz_target.hpp"

#include "miniapp/commands/command_line.hpp"

#include <cmath>
#include <sstream>
#include <vector>

namespace {

using namespace brickwall;
using namespace brickwall::miniapp;
using fuzz::demand;

CommandLine parse(const std::vector<std::string>& words) {
  std::vector<const char*> arguments = {"brickwall"};
  for (const std::string& word : words)
    arguments.push_back(word.c_str());
  return parseCommandLine(static_cast<int>(arguments.size()), arguments.data());
}

std::vector<std::string> wordsOf(const Options& options) {
  static const char* const commands[] = {"run", "check", "mesh", "search"};
  std::vector<std::string> words = {"--output=" + options.output_directory};
  for (const std::string& text : options.overrides)
    words.push_back("--set=" + text);
  if (!options.write_output)
    words.emplace_back("--no-output");
  if (options.timing == Timing::paper)
    words.emplace_back("--timing=paper");
  if (options.quiet)
    words.emplace_back("--quiet");
  if (options.checksums)
    words.emplace_back("--checksums");
  if (options.time_limit) {
    const auto seconds = static_cast<long long>(*options.time_limit);
    char text[64];
    std::snprintf(text, sizeof text, "--time-limit=%lld:%02lld:%02lld", seconds / 3600,
                  seconds / 60 % 60, seconds % 60);
    words.emplace_back(text);
  }
  if (!options.restart.empty())
    words.push_back("--restart=" + options.restart);
  if (options.extend_to) {
    char text[64];
    std::snprintf(text, sizeof text, "--extend-to=%.17g", *options.extend_to);
    words.emplace_back(text);
  }
  words.insert(words.end(), options.kokkos_arguments.begin(), options.kokkos_arguments.end());
  words.insert(words.end(), {"--", commands[static_cast<int>(options.command)], options.deck});
  return words;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream lines(std::string(reinterpret_cast<const char*>(data), size));
  std::vector<std::string> words;
  for (std::string line; std::getline(lines, line);)
    words.push_back(line.substr(0, line.find('\0')));
  const CommandLine line = parse(words);
  if (!line.options) {
    demand(line.exit_code == 0 || line.exit_code == 2, "the exit code is 0 or 2");
    fuzz::demandMessage(line.text);
    return 0;
  }
  const Options& options = *line.options;
  demand(!options.deck.empty() && !options.output_directory.empty(), "deck and folder are named");
  demand(!options.extend_to || (std::isfinite(*options.extend_to) && *options.extend_to > 0),
         "--extend-to is a time");
  demand(!options.time_limit || std::isfinite(*options.time_limit), "--time-limit is a time");
  Options expected = options;
  if (options.checksums) // adds an override, here once more
    expected.overrides.push_back(options.overrides.back());
  const CommandLine again = parse(wordsOf(options));
  demand(again.options.has_value(), "the full form is accepted: " + again.text);
  demand(wordsOf(*again.options) == wordsOf(expected), "the full form means the same");
  return 0;
}
