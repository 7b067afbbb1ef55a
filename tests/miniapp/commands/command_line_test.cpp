// The command line: commands, options and errors.
#include "miniapp/commands/command_line.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace {

using namespace brickwall::miniapp;

CommandLine parse(std::vector<const char*> words) {
  words.insert(words.begin(), "brickwall");
  return parseCommandLine(static_cast<int>(words.size()), words.data());
}

TEST(CommandLine, RunsTheDefaultDeckWithoutWords) {
  const CommandLine line = parse({});
  ASSERT_TRUE(line.options.has_value());
  EXPECT_EQ(line.options->command, Command::run);
  EXPECT_EQ(line.options->deck, "inputs/brick_wall.toml");
  EXPECT_EQ(line.options->caseName(), "brick_wall");
  EXPECT_EQ(line.options->output_directory, "out/brick_wall");
  EXPECT_TRUE(line.options->write_output);
  EXPECT_EQ(line.options->timing, Timing::normal);
}

TEST(CommandLine, TakesTheOptionsOfLongRuns) {
  const CommandLine line =
      parse({"run", "--time-limit", "100:01:30", "--restart", "latest", "--extend-to", "0.5"});
  ASSERT_TRUE(line.options.has_value()) << line.text;
  EXPECT_EQ(line.options->time_limit, 360090.0);
  EXPECT_EQ(line.options->restart, "latest");
  EXPECT_EQ(line.options->extend_to, 0.5);
  EXPECT_EQ(parse({"--time-limit", "90"}).exit_code, 2);
  EXPECT_EQ(parse({"--time-limit", "1:60:00"}).exit_code, 2);
  EXPECT_EQ(parse({"--extend-to", "0.5"}).exit_code, 2);
  EXPECT_EQ(parse({"check", "--restart", "latest"}).exit_code, 2);
}

TEST(CommandLine, TakesNoFreeBricksWithChecksums) {
  const CommandLine line = parse({"--checksums"});
  ASSERT_TRUE(line.options.has_value()) << line.text;
  EXPECT_EQ(line.options->overrides, std::vector<std::string>{"skip.free_bricks=false"});
  EXPECT_EQ(parse({"check", "--checksums"}).exit_code, 2);
}

TEST(CommandLine, TakesCommandDeckAndOptionsInAnyOrder) {
  const CommandLine line =
      parse({"--set", "time.end=1", "check", "--kokkos-threads=2", "decks/a.b.toml", "-o", "here",
             "--set=wall.gap=0", "--steps", "5", "--no-output", "--timing", "paper"});
  ASSERT_TRUE(line.options.has_value()) << line.text;
  EXPECT_EQ(line.options->command, Command::check);
  EXPECT_EQ(line.options->deck, "decks/a.b.toml");
  EXPECT_EQ(line.options->caseName(), "a.b");
  EXPECT_EQ(line.options->output_directory, "here");
  EXPECT_EQ(line.options->overrides,
            (std::vector<std::string>{"time.end=1", "wall.gap=0", "time.steps=5"}));
  EXPECT_EQ(line.options->kokkos_arguments, std::vector<std::string>{"--kokkos-threads=2"});
  EXPECT_FALSE(line.options->write_output);
  EXPECT_EQ(line.options->timing, Timing::paper);
}

TEST(CommandLine, CountsAreIntegersOfAtLeastOne) {
  for (const char* value : {"0", "-4", "abc", "1e3", "1.5", "99999999999999999999"}) {
    const std::string found =
        "found \"" + std::string(value) + "\", expected an integer of at least 1";
    EXPECT_NE(parse({"--steps", value}).text.find(found), std::string::npos) << value;
    // one of the two spellings is that of this Kokkos
    const std::string old = std::string("--kokkos-threads=") + value,
                      present = std::string("--kokkos-num-threads=") + value;
    const CommandLine line = parse({old.c_str(), present.c_str()});
    EXPECT_EQ(line.exit_code, 2) << value;
    EXPECT_NE(line.text.find(found), std::string::npos) << line.text;
  }
}

TEST(CommandLine, TakesTheDeckWithoutACommand) {
  const CommandLine line = parse({"a.toml"});
  ASSERT_TRUE(line.options.has_value());
  EXPECT_EQ(line.options->command, Command::run);
  EXPECT_EQ(line.options->deck, "a.toml");
}

TEST(CommandLine, PrintsHelpVersionAndKeys) {
  const CommandLine help = parse({"-h"});
  EXPECT_FALSE(help.options.has_value());
  EXPECT_EQ(help.exit_code, 0);
  for (const char* part : {"run", "check", "mesh", "search", "--output", "--set", "--steps",
                           "--no-output", "--timing", "--version", "--keys", "--kokkos-"})
    EXPECT_NE(help.text.find(part), std::string::npos) << part << " in\n" << help.text;
  EXPECT_EQ(help.text.find("KEY=VALUE ..."), std::string::npos) << help.text; // it takes one value
  const std::string version = parse({"--version"}).text;
  EXPECT_NE(version.find("brickwall "), std::string::npos);
  EXPECT_EQ(version.find("$<"), std::string::npos) << "a condition of CMake in\n" << version;
  EXPECT_NE(parse({"--keys"}).text.find("[[load.pressure]]"), std::string::npos);
  EXPECT_NE(parse({"--keys", "markdown"}).text.find("| `radius` | number | m | none | > 0 |"),
            std::string::npos);
}

TEST(CommandLine, NamesTheNearestCommand) {
  const auto expect = [](const std::vector<const char*>& words, const std::string& text) {
    const CommandLine line = parse(words);
    EXPECT_EQ(line.exit_code, 2) << words[0];
    EXPECT_NE(line.text.find(text), std::string::npos) << line.text;
  };
  expect({"chek", "a.toml"}, "did you mean \"check\"?");
  expect({"--no-output", "raport"}, "did you mean \"report\"?");
  expect({"-o", "x", "study", "a.toml"}, "\"study\" must be the first word");
  const std::string unlike = parse({"wonderful"}).text;
  EXPECT_NE(unlike.find("study or the path of a deck"), std::string::npos) << unlike;
  EXPECT_EQ(unlike.find("did you mean"), std::string::npos) << unlike;
  for (const char* deck : {"chek.toml", "./chek", "decks/run"})
    EXPECT_TRUE(parse({deck}).options.has_value()) << deck;
}

TEST(CommandLine, RefusesUnknownArguments) {
  const std::vector<std::vector<const char*>> wrong = {{"--unheard"},
                                                       {"--keys", "html"},
                                                       {"check", ""},
                                                       {"--restart", ""},
                                                       {"--restart="},
                                                       {"--set="},
                                                       {"--threads=2"},
                                                       {"run", "a.toml", "b.toml"},
                                                       {"a.toml", "run"},
                                                       {"--steps", "0"},
                                                       {"search", "a.toml", "--steps", "3"},
                                                       {"mesh", "--steps", "3"},
                                                       {"--steps", "1.5"},
                                                       {"--steps"},
                                                       {"--timing", "sometimes"},
                                                       {"--set"}};
  for (const auto& words : wrong) {
    const CommandLine line = parse(words);
    EXPECT_FALSE(line.options.has_value()) << words[0];
    EXPECT_EQ(line.exit_code, 2) << words[0];
    EXPECT_NE(line.text, "") << words[0];
  }
  EXPECT_NE(parse({"-o", ""}).text.find("found \"\" after -o, expected a value"),
            std::string::npos);
  EXPECT_NE(parse({"--timing", "\x1b[31m"}).text.find("--timing: ?[31m not in"), std::string::npos);
}

} // namespace
