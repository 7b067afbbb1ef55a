// Exchanges of contact values among ranks of which some have no ghosts.
#include "tests/miniapp/simulation/case.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace brickwall::miniapp {
namespace {

using verification::Case;

// Of three bricks, one a rank, the last two collide. Later the first is too far from the second for
// ghosts, but within the margin of its box.
Checksums sumsOnPath(const std::string& path) {
  setenv("BRICKWALL_MESSAGES", path.c_str(), 1);
  Case bricks("[wall]\nbricks = [3, 1, 1]\nbrick = [1.0, 1.0, 1.0]\nelements = [4, 4, 4]\n"
              "gap = 0.006\nends = \"ragged\"\n"
              "[material.brick]\ndensity = 1.0\nyoungs_modulus = 1.0\npoissons_ratio = 0.2\n"
              "[search]\nreuse = { margin = 0.0 }\n[time]\nend = 1e3\n"
              "[[initial.velocity]]\nbrick = [2, 0, 0]\nvelocity = [-0.02, 0.0, 0.003]\n");
  bricks.simulation.start();
  std::int64_t num_contacts = 0;
  for (int step = 0; step < 60; ++step) {
    bricks.simulation.step();
    num_contacts += contactCounts(bricks.simulation).active;
  }
  EXPECT_GT(num_contacts, 0);
  unsetenv("BRICKWALL_MESSAGES");
  return checksums(bricks.simulation);
}

TEST(PartnerMessages, ReachPartnersWithoutGhostsOnEveryPath) {
  const Checksums expected = sumsOnPath("auto");
  for (const char* path : {"staged", "peer"}) {
    const Checksums sums = sumsOnPath(path);
    EXPECT_EQ(sums.nodes, expected.nodes) << path;
    EXPECT_EQ(sums.contacts, expected.contacts) << path;
  }
}

} // namespace
} // namespace brickwall::miniapp
