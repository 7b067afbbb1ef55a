// The checksums of the parts of a step: the same on one rank and on all, and different from the
// part on in which two runs differ.
#include "tests/miniapp/simulation/case.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace {

using namespace brickwall;
using miniapp::StepPart;
using verification::Case;

// Sliding bricks under a growing load, with edges and friction; `gravity` as text.
std::string deckOf(const std::string& gravity) {
  return "[wall]\nbricks = [2, 1, 3]\nbrick = [0.2, 0.1, 0.1]\nelements = [4, 2, 2]\n"
         "[material.brick]\ndensity = 2000\nyoungs_modulus = 20e9\npoissons_ratio = 0.2\n"
         "[[load.pressure]]\nside_set = \"front\"\npeak = 1e6\nshape = \"step\"\n"
         "[[boundary.fixed]]\nnode_set = \"base\"\n"
         "[gravity]\nacceleration = [0, 0, " +
         gravity +
         "]\n"
         "[contact]\nfriction = 0.3\n"
         "[time]\nend = 1\n";
}

// Of all parts of the start and of 40 steps.
std::vector<std::uint64_t> checksumsOf(MPI_Comm comm, const std::string& gravity) {
  Case wall(deckOf(gravity), comm);
  std::vector<std::uint64_t> sums;
  wall.simulation.observe(
      [&](StepPart part) { sums.push_back(checksumOf(wall.simulation, part)); });
  wall.simulation.start();
  for (int step = 0; step < 40; ++step)
    wall.simulation.step();
  EXPECT_GT(contactCounts(wall.simulation).active, 0);
  return sums;
}

TEST(StepChecksums, AreThoseOfOneRankOnAnyNumberOfRanks) {
  const auto alone = checksumsOf(MPI_COMM_SELF, "-9.81");
  EXPECT_EQ(alone.size(), 6u * 41);
  EXPECT_EQ(checksumsOf(MPI_COMM_WORLD, "-9.81"), alone);
}

TEST(StepChecksums, TellThePartInWhichTwoRunsBeginToDiffer) {
  const auto one = checksumsOf(MPI_COMM_WORLD, "-9.81");
  const auto other = checksumsOf(MPI_COMM_WORLD, "-9.8100000001");
  const auto first = std::mismatch(one.begin(), one.end(), other.begin()).first - one.begin();
  EXPECT_EQ(first, static_cast<int>(StepPart::velocity)); // of the start
}

} // namespace
