// Former names of blocks, keys and words in decks and overrides.
#include "io/deck/deck.hpp"
#include "tests/support/expect_contains.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace {

using namespace brickwall::io;

// A schema in which a block, a key and two words have been renamed.
const Schema& renamedSchema() {
  static const Schema known = [] {
    KeyRule mode = word("modes", {"fast", "slow"}, "which").list(KeyRule::any_length);
    mode.former_words = {{"quick", "fast"}, {"lame", "slow"}};
    BlockRule skip{"skip", BlockKind::single, "work"};
    skip.keys = {boolean("stationary", "nodes").byDefault("true").formerly("still"), mode};
    skip.former_name = "spare";
    BlockRule inner{"skip.more", BlockKind::single, "more"};
    inner.keys = {integer("count", "of them").byDefault("0")};
    inner.former_name = "extra";
    BlockRule material{"material", BlockKind::named, "a material"};
    material.keys = {real("density", "kg/m3", "density").byDefault(1.0).formerly("rho")};
    return Schema{skip, inner, material};
  }();
  return known;
}

TEST(DeckRenames, AcceptsFormerNamesWithOneWarningEach) {
  const auto read = [](const std::string& text, const std::vector<std::string>& overrides = {}) {
    Deck deck = Deck::parse(text, "a.toml", overrides, renamedSchema());
    EXPECT_EQ(deck.message(), "") << text;
    return deck;
  };
  const std::string present = "[skip]\nstationary = false\nmodes = [\"fast\", \"slow\"]\n"
                              "[skip.more]\ncount = 3\n[material.a]\ndensity = 2.0\n";
  const std::string former = "[spare]\nstill = false\nmodes = [\"quick\", \"slow\"]\n"
                             "[spare.extra]\ncount = 3\n[material.a]\nrho = 2.0\n";
  const std::string expected = read(present).resolved();
  EXPECT_TRUE(read(present).warnings().empty());
  const Deck deck = read(former);
  EXPECT_EQ(deck.resolved(), expected);
  const std::string next = " and will be refused by the next release";
  EXPECT_EQ(deck.warnings(),
            (std::vector<std::string>{
                "a.toml:1: [spare] is the former name of [skip]" + next,
                "a.toml:2: [skip] still is the former name of stationary" + next,
                "a.toml:3: [skip] modes: \"quick\" is the former name of \"fast\"" + next,
                "a.toml:4: [skip.extra] is the former name of [skip.more]" + next,
                "a.toml:7: [material.<name>] rho is the former name of density" + next}));

  // Overrides, with either name in the deck.
  for (const std::string& text : {present, former})
    for (const std::string set : {"spare.still=true", "skip.still=true", "spare.stationary=true"}) {
      const Deck changed = read(text, {set});
      EXPECT_TRUE(changed.boolean("skip", "stationary"));
      EXPECT_CONTAINS(changed.warnings().back(), "--set " + set + ": [");
    }
  const Deck nested = read("[skip]\n", {"spare={still=false}", "spare.extra.count=4",
                                        "material.b.rho=3", "skip.modes=[\"lame\"]"});
  EXPECT_FALSE(nested.boolean("skip", "stationary"));
  EXPECT_EQ(nested.warnings().size(), 6u);
}

TEST(DeckRenames, RefusesAFormerNameBesideThePresentOne) {
  const auto faults = [](const std::string& text) {
    return Deck::parse(text, "a.toml", {}, renamedSchema()).message();
  };
  EXPECT_CONTAINS(faults("[skip]\n[spare]\nstill = true\n"),
                  "a.toml:2: found \"spare\" beside \"skip\", whose former name it is");
  EXPECT_CONTAINS(faults("[skip]\nstationary = true\nstill = true\n"),
                  "a.toml:3: [skip]: found \"still\" beside \"stationary\"");
  EXPECT_CONTAINS(faults("[spare]\nstill = 3\n"),
                  "a.toml:2: [skip] stationary: found the integer 3, expected true or false");
}

} // namespace
