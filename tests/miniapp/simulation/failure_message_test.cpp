// What a run says when loads or energies leave the range of their exact sums.
#include "tests/miniapp/simulation/case.hpp"
#include "tests/support/expect_contains.hpp"

#include <gtest/gtest.h>

#include <string>

namespace brickwall::verification {
namespace {

// A brick of wave speed 1 (nu = 0) and size 2 x 1 x 1.
const std::string brick = "[wall]\nbricks = [1, 1, 1]\nbrick = [2, 1, 1]\nelements = [2, 1, 1]\n"
                          "[material.brick]\ndensity = 1\nyoungs_modulus = 1\n"
                          "poissons_ratio = 0\n[time]\nend = 10\n";

std::string failureOf(const std::string& blocks) {
  Case scene(brick + blocks);
  try {
    scene.simulation.start();
    for (int step = 0; step < 3; ++step)
      scene.simulation.step();
  } catch (const PhysicsError& error) {
    return error.what();
  }
  return "";
}

TEST(FailureMessage, StatesSpeedsBeyondTheRangeOfEnergies) {
  const auto moving = [](const char* speed) {
    return std::string("[[initial.velocity]]\nvelocity = [") + speed + ", 0, 0]\n";
  };
  EXPECT_EQ(failureOf(moving("1000")), "");
  const std::string failure = failureOf(moving("1e7"));
  EXPECT_CONTAINS(failure, "beyond the range of the exact sums");
  EXPECT_CONTAINS(failure, "the fastest node moves at 1e+07, 1e+07 times the least speed of waves");
}

TEST(FailureMessage, StatesLoadsBeyondTheRangeOfForces) {
  const auto pressed = [](const char* peak) {
    return std::string("[[load.pressure]]\nside_set = \"left\"\nshape = \"step\"\npeak = ") + peak +
           "\n";
  };
  EXPECT_EQ(failureOf(pressed("0.1")), "");
  const std::string failure = failureOf(pressed("1e100"));
  EXPECT_CONTAINS(failure, "4 nodal forces of [[load.pressure]]");
  EXPECT_CONTAINS(failure, "which ends at 4, "); // 4 (lambda + 2 mu) h^2
}

} // namespace
} // namespace brickwall::verification
