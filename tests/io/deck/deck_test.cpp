// Decks: every fault is reported with its line, all of them in one pass; defaults, overrides, the
// resolved deck.
#include "contact/base/error.hpp"
#include "io/deck/deck.hpp"
#include "tests/support/expect_contains.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace {

using namespace brickwall;
using namespace brickwall::io;

const Schema& schema() {
  static const Schema known = {
      {"", BlockKind::top, "", {text("title", "a line")}},
      {"wall",
       BlockKind::single,
       "a wall",
       {integer("bricks", "numbers").list(3).mustBeGiven().atLeast(1),
        real("gap", "m", "between bricks").byDefault("0.0").atLeast(0),
        word("ends", {"flush", "ragged"}, "of courses").byDefault("flush")}},
      {"material",
       BlockKind::named,
       "a material",
       {real("density", "kg/m3", "density").mustBeGiven().above(0),
        real("poissons_ratio", "", "ratio").byDefault("0.0").above(-1).below(0.5)}},
      {"load.pressure",
       BlockKind::repeated,
       "a load",
       {text("side_set", "name").mustBeGiven(), real("peak", "Pa", "pressure").byDefault("1.0"),
        boolean("follower", "or dead").byDefault("true"),
        word("components", {"x", "y", "z"}, "which").list(KeyRule::any_length)}},
      {"time",
       BlockKind::single,
       "time",
       {real("end", "s", "last").byDefault("1.0"), integer("steps", "most").atLeast(1)}},
      {"limits", BlockKind::single, "limits", {real("wall_time", "s", "of the clock")}, true},
  };
  return known;
}

Deck parse(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return Deck::parse(text, "a.toml", overrides, schema());
}

// The message of a deck that must be wrong.
std::string faultsOf(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    const Deck deck = parse(text, overrides);
    return deck.message();
  } catch (const InputError& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    return error.what();
  }
}

const std::string good = "[wall]\nbricks = [2, 1, 3]\n[limits]\n";

TEST(Deck, GivesValuesAndDefaults) {
  const Deck deck = parse("title = \"T\"\n" + good + "[material.brick]\ndensity = 2000\n" +
                          "[[load.pressure]]\nside_set = \"front\"\ncomponents = [\"z\", \"x\"]\n" +
                          "[[load.pressure]]\nside_set = 'back'\npeak = 3e6\nfollower = false\n");
  EXPECT_EQ(deck.message(), "");
  EXPECT_EQ(deck.text("", "title"), "T");
  EXPECT_EQ(deck.integers("wall", "bricks"), (std::vector<std::int64_t>{2, 1, 3}));
  EXPECT_EQ(deck.real("wall", "gap"), 0.0);
  EXPECT_EQ(deck.text("wall", "ends"), "flush");
  EXPECT_EQ(deck.names("material"), std::vector<std::string>{"brick"});
  EXPECT_EQ(deck.real("material.brick", "density"), 2000.0); // an integer is a real too
  ASSERT_EQ(deck.count("load.pressure"), 2);
  EXPECT_TRUE(deck.boolean("load.pressure[0]", "follower"));
  EXPECT_EQ(deck.texts("load.pressure[0]", "components"), (std::vector<std::string>{"z", "x"}));
  EXPECT_FALSE(deck.has("load.pressure[1]", "components"));
  EXPECT_EQ(deck.real("load.pressure[1]", "peak"), 3e6);
  EXPECT_FALSE(deck.boolean("load.pressure[1]", "follower"));
  EXPECT_FALSE(deck.isGood("time", "steps"));
  EXPECT_FALSE(deck.hasBlock("time"));
  EXPECT_THROW(deck.real("wall", "unheard"), Error);
}

TEST(Deck, ReportsAllFaultsInOrderOfLines) {
  const std::string message = faultsOf("[wall]\n" // 1
                                       "brcks = [2, 1, 3]\n" // 2 unknown key
                                       "gap = -1.0\n" // 3 out of range
                                       "ends = \"flushed\"\n" // 4 no such word
                                       "[material.brick]\n" // 5 density missing
                                       "poissons_ratio = 0.5\n" // 6 open bound
                                       "[wal]\n" // 7 unknown block
                                       "[time]\n" // 8
                                       "end = true\n" // 9 no number
                                       "steps = 2.0\n" // 10 no integer
                                       "[[load.pressure]]\n" // 11
                                       "side_set = 3\n" // 12 no text
                                       "follower = 1\n" // 13 no boolean
                                       "[limits]\n");
  const std::vector<std::string> reported = {
      "a.toml:1: [wall]: found no key \"bricks\"",
      "a.toml:2: [wall]: found unknown key \"brcks\", expected one of bricks, gap, ends; did you "
      "mean \"bricks\"?\n  2 | brcks = [2, 1, 3]\n    | ^^^^^\n",
      "a.toml:3: [wall] gap: found the real -1.0, expected a finite number at least 0, in m\n"
      "  3 | gap = -1.0\n    |       ^^^^\n",
      "a.toml:4: [wall] ends: found the text \"flushed\", expected one of \"flush\", \"ragged\"; "
      "did "
      "you mean \"flush\"?",
      "a.toml:5: [material.brick]: found no key \"density\", expected density = a finite number "
      "above 0, in kg/m3",
      "a.toml:6: [material.brick] poissons_ratio: found the real 0.5, expected a finite number "
      "above "
      "-1 and below 0.5",
      "a.toml:7: found unknown block \"wal\"",
      "did you mean \"[wall]\"?",
      "a.toml:9: [time] end: found true",
      "a.toml:10: [time] steps: found the real 2.0, expected an integer at least 1",
      "a.toml:12: [[load.pressure]] side_set: found the integer 3, expected a text",
      "a.toml:13: [[load.pressure]] follower: found the integer 1, expected true or false"};
  std::size_t place = 0;
  for (const std::string& part : reported) {
    const std::size_t found = message.find(part, place);
    EXPECT_NE(found, std::string::npos) << part << "\nis not, or not in order, in:\n" << message;
    if (found != std::string::npos)
      place = found;
  }
}

TEST(Deck, RefusesNumbersThatDoNotFit) {
  for (const std::string number : {"nan", "-inf", "inf", "1e400", "-1e400", "1e9999999"})
    EXPECT_CONTAINS(faultsOf(good + "[time]\nend = " + number + "\n"),
                    "a.toml:5: [time] end: found");
  EXPECT_CONTAINS(faultsOf(good + "[time]\nend = 1e400\n"), "too large");
  // toml11 alone would silently take these as 2^63 - 1.
  EXPECT_CONTAINS(faultsOf(good + "[time]\nsteps = 12345678901234567890\n"), "beyond 64 bits");
  EXPECT_CONTAINS(faultsOf(good + "[time]\nend = 123456789012345678901234567890\n"), "too large");
  EXPECT_EQ(faultsOf(good + "[time]\nsteps = 9223372036854775807\nend = 1_000.5\n"), "");
  EXPECT_EQ(parse(good + "[time]\nsteps = 0x1F\n").integer("time", "steps"), 31);
}

TEST(Deck, ChecksLengthsAndEntriesOfLists) {
  EXPECT_CONTAINS(
      faultsOf("[wall]\nbricks = [2, 1]\n[limits]\n"),
      "a.toml:2: [wall] bricks: found a list of 2, expected a list of 3 integers each at least 1");
  EXPECT_CONTAINS(faultsOf("[wall]\nbricks = 2\n[limits]\n"),
                  "found the integer 2, expected a list of 3");
  EXPECT_CONTAINS(faultsOf("[wall]\nbricks = [2,\n 0,\n 1.0]\n[limits]\n"),
                  "a.toml:3: [wall] bricks: found the integer 0");
  EXPECT_CONTAINS(faultsOf("[wall]\nbricks = [2,\n 0,\n 1.0]\n[limits]\n"),
                  "a.toml:4: [wall] bricks: found the real 1.0");
  EXPECT_CONTAINS(faultsOf(good + "[time]\nend = [1.0]\n"),
                  "found a list of 1, expected a finite number");
}

TEST(Deck, ReportsWrongKindsOfTables) {
  EXPECT_CONTAINS(faultsOf("[[wall]]\nbricks = [2, 1, 3]\n[limits]\n"),
                  "expected one table [wall]");
  EXPECT_CONTAINS(faultsOf(good + "[load.pressure]\nside_set = \"a\"\n"),
                  "expected an array of tables: [[load.pressure]]");
  EXPECT_CONTAINS(faultsOf(good + "[material]\ndensity = 1.0\n"),
                  "expected a table [material.<name>]");
  EXPECT_CONTAINS(faultsOf("wall = 3\n[limits]\n"),
                  "a.toml:1: wall: found the integer 3, expected one table [wall]");
  EXPECT_CONTAINS(faultsOf("load = 3\n" + good), "a.toml:1: load: found the integer 3");
  EXPECT_CONTAINS(faultsOf(good + "[load]\npresure = 3\n"), "unknown key \"load.presure\"");
  EXPECT_CONTAINS(faultsOf(good + "[[pressure]]\nside_set = \"a\"\n"),
                  "did you mean \"[[load.pressure]]\"?");
  EXPECT_CONTAINS(faultsOf(good + "[[load.time]]\nend = 1.0\n"), "did you mean \"[time]\"?");
  EXPECT_CONTAINS(faultsOf(good + "[load.time]\nend = 1.0\n"), "did you mean \"[time]\"?");
  EXPECT_CONTAINS(faultsOf(good + "[materials.clay]\ndensity = 1.0\n"),
                  "did you mean \"[material.<name>]\"?");
  EXPECT_CONTAINS(faultsOf("[[wall]]\nbricks = [2, 1, 3]\n[limits]\n"),
                  "found an array of tables [[wall]], expected one table [wall]");
  EXPECT_CONTAINS(faultsOf("wall = [3]\n[limits]\n"),
                  "found a list of 1, expected one table [wall]");
  EXPECT_CONTAINS(faultsOf(good + "[[material.clay]]\ndensity = 1.0\n"),
                  "found an array of tables [[material.clay]], expected a table [material.<name>]");
  EXPECT_CONTAINS(faultsOf(good + "[time]\ngap = 1.0\n"), "(gap is a key of [wall])");
}

TEST(Deck, ReportsWhereABlockStands) {
  const Deck deck = parse(good + "[[load.pressure]]\nside_set = \"a\"\n",
                          {"load.pressure[1].side_set=\"b\"", "load.pressure[0].peak=2"});
  EXPECT_EQ(deck.placeOf("load.pressure[0]"), "a.toml:4");
  EXPECT_EQ(deck.placeOf("load.pressure[0]", "side_set"), "a.toml:4");
  EXPECT_EQ(deck.placeOf("load.pressure[0]", "peak"), "--set load.pressure[0].peak=2");
  EXPECT_EQ(deck.placeOf("load.pressure[1]"), "--set load.pressure[1].side_set=\"b\"");
}

TEST(Deck, ReportsMissingBlocks) {
  EXPECT_CONTAINS(faultsOf("[wall]\nbricks = [1, 1, 1]\n"), "a.toml:2: found no block [limits]");
  EXPECT_EQ(faultsOf("[limits]\n"), ""); // keys of [wall] count only when it is given
}

TEST(Deck, StopsAtASyntaxError) {
  EXPECT_CONTAINS(faultsOf(good + "gap = \n"),
                  "a.toml:4: found no value after =, expected a number, true, false, a text");
  EXPECT_CONTAINS(faultsOf("[wall]\nbricks = [2, 1\n\ngap = 1\n"),
                  "a.toml:4: found no comma after a value in a list, expected a comma or ]\n");
  EXPECT_CONTAINS(faultsOf("[wall]\ngap = 1.0\ngap = 2.0\n"),
                  "a.toml:3: found value (\"gap\") already exists (value defined twice), "
                  "expected each key once\n");
  EXPECT_CONTAINS(faultsOf("[wall]\ngap = 1.0\n[time]\n[wall]\n\n\n"),
                  "a.toml:4: found table (\"wall\") already exists");
  EXPECT_CONTAINS(faultsOf("[wall]\ngap = 1979-99-99\n"), "a.toml:2: found invalid date");
  EXPECT_CONTAINS(faultsOf("[wall]\ngap = 1.\n"), "a.toml:2: found");
  EXPECT_CONTAINS(faultsOf("[wall]\nbricks = " + std::string(100000, '[') + "\n"),
                  "a.toml:2: found brackets nested too deeply");
  EXPECT_CONTAINS(faultsOf("x = \"\"\"\n\"\"\"\ny = " + std::string(100000, '[') + "\n"),
                  "a.toml:3: found brackets nested too deeply");
}

// Each syntax error says what to write instead.
TEST(Deck, SaysWhatItExpectedAtEachSyntaxError) {
  const std::pair<std::string, std::string> lines[] = {
      {"gap = 2.0 m", "found 'm' after a value, expected the end of the line, or # and a comment"},
      {"gap = 2,0", "found ',' after a value, expected the end of the line"},
      {"gap = 02", "found bad integer: leading zero, expected digits only, such as 1000 or 1_000"},
      {"gap = 2.", "expected digits before and after the point, such as 2.0"},
      {"gap: 2", "found no = after a key, expected key = value"},
      {" = 2", "found no key before =, expected key = value"},
      {"gap = yes", "found a value of no known kind, expected a number, true, false, a text in"},
      {"ends = flush", "found a word without quotation marks, expected true, false or a text"},
      {"ends = 'flush\"", "does not end on its line, expected a quotation mark ' at its end"},
      {"ends = \"C:\\dir\"", "expected a quotation mark at its end, and \\\\ for a backslash"},
      {"bricks = [2,, 1]",
       "found no value at this place of a list, expected a value after each comma"},
      {"[time", "found an invalid key, expected key = value, [table] or [[table]]"},
      {"[time]]", "found more after the name of a table, expected [table] or [[table]] on a line"},
      {"[wall]",
       "found table (\"wall\") already exists (table defined twice), expected each table once"},
      {"gap = 1979-99-99", "expected valid TOML (https://toml.io)"}};
  for (const auto& [line, sentence] : lines)
    EXPECT_CONTAINS(faultsOf("[wall]\n" + line + "\n"), sentence);
}

TEST(Deck, RefusesWhatWouldExhaustStackOrPatience) {
  std::string names = "a";
  for (int i = 0; i < 100000; ++i)
    names += ".a";
  for (const std::string& text : {"[" + names + "]\n", names + " = 1\n", "x = 1.5\n" + names})
    EXPECT_CONTAINS(faultsOf(text), "found a dotted key of too many names, expected at most 64");
  EXPECT_CONTAINS(faultsOf("[wall]\nbricks = [" + std::string(100000, ' ') + "1, 1, 1]\n"),
                  "a.toml:2: found a line that is too long, expected at most 16384 bytes");
  std::string lines;
  for (int i = 0; i < 1000; ++i)
    lines += "k" + std::to_string(i) + " = 1.5\n";
  const std::string message = faultsOf(good + "[time]\n" + lines);
  EXPECT_CONTAINS(message, "unknown key \"k199\"");
  EXPECT_EQ(message.find("unknown key \"k200\""), std::string::npos);
  EXPECT_CONTAINS(message, "and 800 more faults");
}

TEST(Deck, ReadsByteOrderMarksAndCarriageReturns) {
  EXPECT_EQ(faultsOf("\xEF\xBB\xBF[wall]\r\nbricks = [2, 1, 3]\r\n[limits]\r\n"), "");
  EXPECT_CONTAINS(faultsOf("\xEF\xBB\xBF[wall]\r\nbrickz = [2, 1, 3]\r\n[limits]"),
                  "a.toml:2: [wall]: found unknown key");
}

TEST(Deck, ReportsAnEmptyDeck) {
  for (const std::string text : {"", "\n\n", "# nothing\n"})
    EXPECT_CONTAINS(faultsOf(text), "a.toml:1: found an empty deck");
}

TEST(Deck, NamesFilesThatCannotBeRead) {
  for (const std::string path : {"no/such/deck.toml", "/"}) {
    try {
      Deck::read(MPI_COMM_WORLD, path, {}, schema());
      FAIL();
    } catch (const InputError& error) {
      EXPECT_CONTAINS(std::string(error.what()), path);
    }
  }
}

TEST(Deck, TakesOverrides) {
  const std::string text = good + "[[load.pressure]]\nside_set = \"front\"\n";
  const Deck deck = parse(text, {"load.pressure[0].peak=2e6", "load.pressure.0.side_set=back",
                                 "load.pressure[1].side_set=\"left side\"", "wall.bricks=[4,1,2]",
                                 "wall.ends=ragged", "time.end=2", "time.end = 3",
                                 "material.clay.density=1800.0", "title=12 walls = nice"});
  EXPECT_EQ(deck.message(), "");
  EXPECT_EQ(deck.real("load.pressure[0]", "peak"), 2e6);
  EXPECT_EQ(deck.text("load.pressure[0]", "side_set"), "back");
  EXPECT_EQ(deck.text("load.pressure[1]", "side_set"), "left side");
  EXPECT_EQ(deck.integers("wall", "bricks"), (std::vector<std::int64_t>{4, 1, 2}));
  EXPECT_EQ(deck.text("wall", "ends"), "ragged");
  EXPECT_EQ(deck.real("material.clay", "density"), 1800.0);
  EXPECT_EQ(deck.text("", "title"), "12 walls = nice");
}

TEST(Deck, NamesTheOptionOfAWrongOverride) {
  EXPECT_CONTAINS(faultsOf(good, {"wall.gap=-1"}),
                  "--set wall.gap=-1: [wall] gap: found the integer -1");
  EXPECT_CONTAINS(faultsOf(good, {"wall.gp=1"}),
                  "--set wall.gp=1: [wall]: found unknown key \"gp\"");
  // nothing more: the block is not missing
  EXPECT_EQ(faultsOf(good, {"limits=1"}), "--set limits=1: limits: found the integer 1, expected "
                                          "one table [limits], whose keys are wall_time");
  EXPECT_CONTAINS(faultsOf(good, {"title=b\xe9"}), "found bytes that are not UTF-8");
  EXPECT_CONTAINS(faultsOf(good, {"title=\xf0\x9f\xa7"}), "found bytes that are not UTF-8");
  EXPECT_EQ(faultsOf(good, {"title=b\xc3\xa9 \xf0\x9f\xa7\xb1"}), "");
  EXPECT_CONTAINS(faultsOf(good, {"wal.gap=1"}), "did you mean \"[wall]\"?");
  EXPECT_CONTAINS(faultsOf(good, {"wall.gap=wide"}),
                  "found the text \"wide\", expected a finite number");
  EXPECT_CONTAINS(faultsOf(good, {"wall.gap"}), "expected block.key=value");
  EXPECT_CONTAINS(faultsOf(good, {"wall..gap=1"}), "expected block.key=value");
  EXPECT_CONTAINS(faultsOf(good, {"load.pressure[1].peak=1"}), "found index \"1\"");
  EXPECT_CONTAINS(faultsOf(good, {"load.pressure[0].peak=1"}),
                  "--set load.pressure[0].peak=1: [[load.pressure]]: found no key \"side_set\"");
  EXPECT_CONTAINS(faultsOf(good, {"time.end=1\nsteps=2"}),
                  "--set time.end=1?steps=2: [time] end: found the text");
  EXPECT_CONTAINS(faultsOf(good, {"wall.gap.x=1"}), "--set wall.gap.x=1");
}

TEST(Deck, ExplainsNumbersWithoutALeadingDigit) {
  const std::string hint = "expected a digit before the point of a number, such as -0.5 for -.5";
  EXPECT_CONTAINS(faultsOf("[wall]\ngap = .5\n[limits]\n"), hint);
  EXPECT_CONTAINS(faultsOf(good, {"time.end=.5"}), hint);
  EXPECT_CONTAINS(faultsOf(good, {"load.pressure=[{side_set=\"a\", peak=-.002}]"}), hint);
  EXPECT_CONTAINS(faultsOf(good, {"wall.bricks=[1, 2"}), "--set wall.bricks=[1, 2: found ");
}

TEST(Deck, PutsOverridesBehindTheLines) {
  const std::string message = faultsOf("[wall]\nbricks = [0, 1, 1]\n[limits]\n", {"time.end=x"});
  EXPECT_LT(message.find("a.toml:2"), message.find("--set time.end=x"));
}

TEST(Deck, ResolvesToItself) {
  const Deck deck = parse("title = \"quotes \\\" and \\\\ and \\t, \xC3\xA4\"\n" + good +
                              "[material.\"odd name\"]\ndensity = 1e-300\npoissons_ratio = 0.1\n" +
                              "[[load.pressure]]\nside_set = \"a\"\npeak = 123456789.125\n" +
                              "components = [\"x\"]\n",
                          {"time.end=1e22"});
  ASSERT_EQ(deck.message(), "");
  const std::string resolved = deck.resolved();
  const Deck again = parse(resolved);
  EXPECT_EQ(again.message(), "");
  EXPECT_EQ(again.resolved(), resolved);
  EXPECT_CONTAINS(resolved, "ends = \"flush\"\n");
  EXPECT_CONTAINS(resolved, "gap = 0.0 # m\n");
  EXPECT_EQ(again.real("material.odd name", "density"), 1e-300);
  EXPECT_EQ(again.real("load.pressure[0]", "peak"), 123456789.125);
  EXPECT_EQ(again.real("time", "end"), 1e22);
  EXPECT_EQ(again.text("", "title"), deck.text("", "title"));
}

TEST(Deck, ReadsTablesInsideABlock) {
  const Schema nested = {{"search",
                          BlockKind::single,
                          "a search",
                          {word("method", {"plain", "fast"}, "how").byDefault("plain")}},
                         {"search.reuse",
                          BlockKind::single,
                          "of its lists",
                          {real("margin", "m", "length").byDefault("0.0").atLeast(0)}}};
  const auto read = [&](const std::string& text, const std::vector<std::string>& overrides = {}) {
    return Deck::parse(text, "a.toml", overrides, nested);
  };
  for (const std::string text :
       {"[search]\nreuse = { margin = 0.25 }\n", "[search.reuse]\nmargin = 0.25\n",
        "[search]\nmethod = \"fast\"\nreuse.margin = 0.25\n"}) {
    const Deck deck = read(text);
    EXPECT_EQ(deck.message(), "") << text;
    EXPECT_EQ(deck.real("search.reuse", "margin"), 0.25) << text;
    EXPECT_EQ(read(deck.resolved()).resolved(), deck.resolved());
  }
  EXPECT_EQ(read("[search]\n").real("search.reuse", "margin"), 0.0);
  for (const std::string set : {"search.reuse.margin=0.5", "search.reuse={margin=0.5}"})
    EXPECT_EQ(read("[search]\nreuse = { margin = 0.25 }\n", {set}).real("search.reuse", "margin"),
              0.5);
  EXPECT_CONTAINS(read("[search]\nreuse = { margn = 1 }\n").message(), "unknown key \"margn\"");
  EXPECT_CONTAINS(read("[search]\nreuse = 0.25\n").message(), "one table [search.reuse]");
  EXPECT_CONTAINS(read("[search]\nreuze = { margin = 1 }\n").message(), "one of method, reuse");
  EXPECT_CONTAINS(read("[search]\nreuse = { margin = -1 }\n").message(), "at least 0");
}

TEST(Deck, JoinsTheFaultsOfItsUser) {
  Deck deck = parse(good + "[time]\nend = -1.0\nsteps = 0\n");
  deck.complain("time", "end", "an end in the past", "one above 0");
  deck.complain("limits", "", "too few limits", "more");
  const std::string message = deck.message();
  EXPECT_CONTAINS(message, "a.toml:5: [time] end: found an end in the past, expected one above 0");
  EXPECT_CONTAINS(message, "a.toml:3: [limits]: found too few limits");
  EXPECT_LT(message.find("a.toml:3"), message.find("a.toml:5"));
  EXPECT_LT(message.find("a.toml:5"), message.find("a.toml:6"));
  EXPECT_THROW(deck.finish(), InputError);
}

TEST(Deck, FindsTheNearestName) {
  EXPECT_EQ(nearestName("tolerence", {"penalty", "tolerance"}), "tolerance");
  EXPECT_EQ(nearestName("zzzzzz", {"penalty", "tolerance"}), "");
}

} // namespace
