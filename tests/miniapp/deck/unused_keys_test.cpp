// Keys that have no effect cause a warning with their place, and no other keys do.
#include "miniapp/deck/config.hpp"

#include <gtest/gtest.h>

namespace {

using namespace brickwall::miniapp;

const std::string wall = "[wall]\nbricks = [2, 1, 1]\nbrick = [2, 1, 1]\nelements = [2, 1, 1]\n"
                         "[material.brick]\ndensity = 1.0\nyoungs_modulus = 1.0\n"
                         "poissons_ratio = 0.3\n[time]\nend = 8.0\n"; // 10 lines

std::vector<std::string> warningsOf(const std::string& blocks,
                                    const std::vector<std::string>& overrides = {}) {
  return parseConfig(wall + blocks, "a.toml", overrides).warnings;
}

using Lines = std::vector<std::string>;

TEST(UnusedKeys, OfFrictionAndBalanceAreNamed) {
  EXPECT_EQ(warningsOf("[contact]\nfriction_stiffness = 0.5\n"),
            Lines{"a.toml:12: [contact] friction_stiffness has no effect: contact.friction is 0"});
  EXPECT_EQ(warningsOf("[contact]\nfriction_stiffness = 0.5\nfriction = 0.1\n"), Lines{});
  EXPECT_EQ(warningsOf("", {"partition.interval=5"}),
            Lines{"--set partition.interval=5: [partition] interval has no effect: "
                  "partition.rebalance is \"never\""});
  EXPECT_EQ(warningsOf("[partition]\ninterval = 5\nrebalance = \"auto\"\n"), Lines{});
}

TEST(UnusedKeys, OfInitialConditionsThatLaterOnesReplaceAreNamed) {
  const std::string all = "[[initial.velocity]]\nvelocity = [1, 0, 0]\n", one = all + "body = 1\n";
  EXPECT_EQ(warningsOf(one + all),
            Lines{"a.toml:11: [[initial.velocity]] has no effect: a.toml:14 sets all bodies anew"});
  EXPECT_EQ(warningsOf(all + one), Lines{});
  EXPECT_EQ(warningsOf(one + one), Lines{});
  const std::string deformed =
      "[[initial.deformation]]\ngradient = [0, 0, 0, 0, 0, 0, 0, 0, 0.1]\n";
  EXPECT_EQ(warningsOf(deformed + deformed).size(), 1u);
}

TEST(UnusedKeys, AreNotTheDefaultsOfAResolvedDeck) {
  const Config config = parseConfig(wall, "a.toml");
  EXPECT_EQ(parseConfig(config.resolved_deck, "b.toml").warnings, Lines{});
}

} // namespace
