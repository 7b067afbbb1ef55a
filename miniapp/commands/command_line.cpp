// CLI11 reads all arguments but --kokkos-*.
#include "miniapp/commands/command_line.hpp"

#include "io/deck/deck.hpp"
#include "io/deck/terminal_text.hpp"
#include "miniapp/deck/config.hpp"
#include "miniapp/deck/deck_reference.hpp"
#include "miniapp/output/report.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <regex>

namespace brickwall::miniapp {
namespace {

constexpr const char* description =
    "Brickwall: coupled explicit dynamics of hexahedral bricks with contact.\n\n"
    "Commands (default run):\n"
    "  run     simulate the deck: Exodus output, history, report, table of phases, PASS or FAIL\n"
    "  check   validate the deck and describe its scene; writes nothing\n"
    "  mesh    write the Exodus mesh of the deck\n"
    "  search  time the global and local search alone on the surface of the wall\n"
    "  report  compare finished runs (brickwall report -h)\n"
    "  study   make many runs from one file, repeated and in random order (brickwall study -h)\n\n"
    "Exit code: 0 PASS, 1 internal error, 2 bad deck or command line, 3 the computation failed or\n"
    "a limit of the deck is broken, 4 an output could not be written, 5 a signal or --time-limit\n"
    "ended the run early: --restart latest continues it.";

// As this Kokkos spells it.
const std::string threads_option =
    KOKKOS_VERSION < 30700 ? "--kokkos-threads" : "--kokkos-num-threads";
const std::string footer = "Options --kokkos-* go to Kokkos, such as " + threads_option + "=2.";

bool startsWith(const std::string& text, const std::string& prefix) {
  return text.compare(0, prefix.size(), prefix) == 0;
}

Command commandOf(const std::string& word) {
  return word == "check"    ? Command::check
         : word == "mesh"   ? Command::mesh
         : word == "search" ? Command::search
                            : Command::run;
}

bool isCommand(const std::string& word) {
  return word == "run" || word == "check" || word == "mesh" || word == "search";
}

// "" or the fault of a text that is no integer from 1 to 10^15 - 1.
std::string faultOfCount(const std::string& text) {
  return std::regex_match(text, std::regex("[1-9]\\d{0,14}"))
             ? ""
             : "found \"" + text + "\", expected an integer of at least 1";
}

// Seconds of hh:mm:ss; nothing for another form.
std::optional<double> secondsOf(const std::string& text) {
  std::smatch parts;
  if (!std::regex_match(text, parts, std::regex("(\\d{1,6}):([0-5]\\d):([0-5]\\d)")))
    return {};
  return 3600 * std::stod(parts[1]) + 60 * std::stod(parts[2]) + std::stod(parts[3]);
}

// "" or the fault of a first word that is neither a command nor looks like the path of a deck.
std::string faultOfFirst(const std::string& word) {
  if (word == "report" || word == "study") // programs of their own (companion.hpp)
    return "\"" + word + "\" must be the first word: brickwall " + word + " ...";
  std::error_code none;
  if (word.find_first_of("./") != std::string::npos || std::filesystem::exists(word, none))
    return "";
  const std::string nearest =
      io::nearestName(word, {"run", "check", "mesh", "search", "report", "study"});
  return "found \"" + word +
         "\", expected run, check, mesh, search, report, study or the path of a deck" +
         (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?");
}

// The first positional argument is the command if it is one of the four words, otherwise the deck.
std::string takePositionals(const std::vector<std::string>& words, Options& options) {
  std::size_t next = 0;
  if (next < words.size() && isCommand(words[next])) {
    options.command = commandOf(words[next++]);
  } else if (next < words.size()) {
    std::string fault = faultOfFirst(words[next]);
    if (!fault.empty())
      return fault;
  }
  if (next < words.size())
    options.deck = words[next++];
  if (next == words.size())
    return "";
  const std::string hint =
      isCommand(words[0]) ? "one deck" : "a command (run, check, mesh or search), then one deck";
  return "found \"" + words[next] + "\" after the deck \"" + options.deck + "\", expected " + hint;
}

// What CLI11 reads and takeArguments() turns into options.
struct Arguments {
  std::vector<std::string> positionals;
  std::int64_t steps = 0;
  std::string timing = "normal", time_limit, keys;
  double extend_to = 0;
  bool no_output = false, version = false;
};

void addOptions(CLI::App& app, Arguments& given, Options& options) {
  app.add_option("command", given.positionals,
                 "[run|check|mesh|search] [DECK]; default: run inputs/brick_wall.toml")
      ->type_name("");
  app.add_option("-o,--output", options.output_directory,
                 "folder for all output; default: out/<deck name>")
      ->type_name("DIR");
  app.add_option("--set", options.overrides,
                 "override one key of the deck, such as --set time.end=0.01 or\n"
                 "--set load.pressure[0].peak=1e6; each further key needs a --set of its own,\n"
                 "and of several for one key the last one wins")
      ->option_text("KEY=VALUE")
      ->allow_extra_args(false);
  app.add_option("--steps", given.steps, "end after N steps (--set time.steps=N)")
      ->option_text("N")
      ->check(faultOfCount);
  app.add_option("--time-limit", given.time_limit,
                 "end the run after this wall clock time, with output and a checkpoint")
      ->type_name("HH:MM:SS");
  app.add_option("--restart", options.restart,
                 "continue from a checkpoint: latest (in the output folder), or the path of one or "
                 "of a run")
      ->type_name("latest|PATH");
  app.add_option("--extend-to", given.extend_to,
                 "with --restart: run on to this time of the simulation")
      ->type_name("TIME")
      ->check(CLI::PositiveNumber);
  app.add_flag("--no-output", given.no_output, "write no files");
  app.add_option("--timing", given.timing,
                 "normal, or paper: fences and barriers between the phases of the search,\n"
                 "which separate waiting from work")
      ->type_name("HOW")
      ->check(CLI::IsMember({"normal", "paper"}));
  app.add_flag("-q,--quiet", options.quiet, "print warnings and the last lines only");
  app.add_flag("--checksums", options.checksums,
               "print checksums of each part of each step, to compare runs bit by bit");
  app.add_option("--keys", given.keys, "list all blocks and keys of a deck, as text or Markdown")
      ->type_name("[markdown]")
      ->expected(0, 1)
      ->check(CLI::IsMember({"markdown"}));
  app.add_flag("--version", given.version, "version, commit, compiler, flags, Kokkos");
}

// Sorts argv into options of Kokkos and `words`, which are in reverse order, as CLI11 expects them.
// Returns "" or the fault.
std::string takeWords(int argc, const char* const* argv, std::vector<std::string>& words,
                      Options& options) {
  for (int i = argc - 1; i > 0; --i) {
    const std::string word = argv[i]; // empty as that of a shell's variable that is not set
    if (word.empty() || (startsWith(word, "--") && word.find('=') + 1 == word.size()))
      return "found \"" + word + "\"" + (i > 1 ? std::string(" after ") + argv[i - 1] : "") +
             ", expected a value";
    // Kokkos divides by the number of threads.
    if (startsWith(word, threads_option + "="))
      if (const std::string fault = faultOfCount(word.substr(word.find('=') + 1)); !fault.empty())
        return threads_option + ": " + fault;
    if (startsWith(word, "--kokkos-"))
      options.kokkos_arguments.insert(options.kokkos_arguments.begin(), argv[i]);
    else
      words.push_back(word);
  }
  return "";
}

// Returns "" or the fault.
std::string takeArguments(const CLI::App& app, const Arguments& given, Options& options) {
  const bool has_steps = app.count("--steps") > 0, extends = app.count("--extend-to") > 0;
  std::string surplus = takePositionals(given.positionals, options);
  if (!surplus.empty())
    return surplus;
  if (has_steps && (options.command == Command::mesh || options.command == Command::search))
    return "--steps: 'brickwall mesh' makes no steps, and the number of searches of "
           "'brickwall search' is search.repetitions";
  if (options.command != Command::run &&
      (!given.time_limit.empty() || !options.restart.empty() || extends || options.checksums))
    return "--time-limit, --restart, --extend-to and --checksums belong to 'brickwall run'";
  if (!given.time_limit.empty() && !(options.time_limit = secondsOf(given.time_limit)))
    return "--time-limit: found \"" + given.time_limit +
           "\", expected hours, minutes and seconds, such as 01:30:00";
  if (extends && options.restart.empty())
    return "--extend-to needs --restart; a run from the start ends at time.end of its deck";
  if (extends)
    options.extend_to = given.extend_to;
  if (has_steps)
    options.overrides.push_back("time.steps=" + std::to_string(given.steps));
  if (options.checksums) // free bricks have no forces of their own in a step, and drift at its end
    options.overrides.push_back("skip.free_bricks=false");
  options.write_output = !given.no_output;
  options.timing = given.timing == "paper" ? Timing::paper : Timing::normal;
  if (options.output_directory.empty())
    options.output_directory = "out/" + options.caseName();
  return "";
}

CommandLine endWith(const std::string& fault) {
  return {std::nullopt,
          "brickwall: " + io::terminalText(fault) + "\nbrickwall -h lists all options\n", 2};
}

} // namespace

std::string Options::caseName() const {
  return std::filesystem::path(deck).stem().string();
}

CommandLine parseCommandLine(int argc, const char* const* argv) {
  Options options;
  Arguments given;
  CLI::App app(description, "brickwall");
  app.footer(footer);
  addOptions(app, given, options);
  std::vector<std::string> words;
  std::string fault = takeWords(argc, argv, words, options);
  if (!fault.empty())
    return endWith(fault);
  try {
    app.parse(words);
  } catch (const CLI::CallForHelp&) {
    return {std::nullopt, app.help(), 0};
  } catch (const CLI::ParseError& error) {
    return endWith(error.what());
  }
  if (given.version)
    return {std::nullopt, versionText(), 0};
  if (app.count("--keys") > 0)
    return {std::nullopt,
            given.keys == "markdown" ? deckReference(deckSchema()) : io::describe(deckSchema()), 0};
  fault = takeArguments(app, given, options);
  if (!fault.empty())
    return endWith(fault);
  return {options, "", 0};
}

} // namespace brickwall::miniapp
