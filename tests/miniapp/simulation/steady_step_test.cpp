// A steady step allocates no View: every buffer of the step is kept by its owner.
#include "tests/miniapp/simulation/case.hpp"
#include "tests/support/allocations.hpp"

#include <gtest/gtest.h>

namespace {

using brickwall::verification::Case;

using brickwall::testing::allocationsOf;
using brickwall::testing::no_allocations;

TEST(SteadyStep, OfBricksInContactAllocatesNoView) {
  // Bricks that press against each other and slide, with edges, friction, viscosity and loads;
  // lists of candidates are kept or rebuilt in every step.
  for (const char* search : {"", "[search]\nreuse = { margin = 0.0 }\n"}) {
    Case wall(
        std::string("[wall]\nbricks = [2, 1, 3]\nbrick = [0.2, 0.1, 0.1]\nelements = [4, 2, 2]\n"
                    "[material.brick]\ndensity = 2000\nyoungs_modulus = 20e9\n"
                    "poissons_ratio = 0.2\n"
                    "[[load.pressure]]\nside_set = \"top\"\npeak = 1e6\nshape = \"step\"\n"
                    "[[boundary.fixed]]\nnode_set = \"base\"\n"
                    "[gravity]\nacceleration = [0, 0, -9.81]\n"
                    "[viscosity]\nlinear = 0.06\n"
                    "[contact]\nfriction = 0.3\ndamping = 0.05\n"
                    "[time]\nend = 1\ncheck_interval = 20\n") +
        search);
    auto& simulation = wall.simulation;
    simulation.start();
    for (int step = 0; step < 200; ++step)
      simulation.step();
    EXPECT_GT(contactCounts(simulation).active, 0);
    const auto steps = [&] {
      for (int step = 0; step < 50; ++step)
        simulation.step();
    };
    EXPECT_EQ(allocationsOf(steps), no_allocations);
  }
}

TEST(SteadyStep, OfFreeBricksAllocatesNoView) {
  Case wall("[wall]\nbricks = [2, 1, 3]\nbrick = [0.2, 0.1, 0.1]\nelements = [4, 2, 2]\n"
            "[material.brick]\ndensity = 2000\nyoungs_modulus = 20e9\n"
            "poissons_ratio = 0.2\n"
            "[[boundary.fixed]]\nnode_set = \"base\"\n"
            "[gravity]\nacceleration = [0, 0, -9.81]\n"
            "[contact]\nenabled = false\n"
            "[time]\nend = 1\ncheck_interval = 1000\n");
  auto& simulation = wall.simulation;
  if (brickwall::simd_width > 1) {
    EXPECT_GT(specialElements(simulation).free, 0);
  }
  simulation.start();
  for (int step = 0; step < 10; ++step)
    simulation.step();
  const auto steps = [&] {
    for (int step = 0; step < 50; ++step)
      simulation.step();
  };
  EXPECT_EQ(allocationsOf(steps), no_allocations);
}

} // namespace
