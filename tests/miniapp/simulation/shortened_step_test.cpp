// A step that is shortened in the middle of a run. If each kick spans half of the steps before and
// after it, (dt^- + dt^+)/2, the centre of a brick in free fall moves by exactly g t^2/2 for any
// lengths of the steps.
#include "tests/miniapp/simulation/case.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using brickwall::verification::Case;
using brickwall::verification::printResult;

TEST(ShortenedStep, LeavesFreeFallExact) {
  // The dead load compresses the brick along y only. The St.Venant-Kirchhoff material stiffens in
  // the rebound.
  Case brick(
      "[wall]\nbricks = [1, 1, 1]\nbrick = [0.2, 0.1, 0.1]\nelements = [4, 2, 2]\n"
      "[material.brick]\nmodel = \"svk\"\ndensity = 2000\nyoungs_modulus = 20e9\n"
      "poissons_ratio = 0.2\n"
      "[[load.pressure]]\nside_set = \"front\"\nfollower = false\npeak = 4e9\nduration = 2e-4\n"
      "[gravity]\nacceleration = [0, 0, -1e4]\n"
      "[time]\nend = 1e-3\ncheck_interval = 10\n");
  auto& simulation = brick.simulation;
  simulation.start();
  const double first_dt = simulation.clock().dt;
  while (!simulation.isDone())
    simulation.step();
  const double time = simulation.clock().time;
  EXPECT_LT(simulation.clock().dt, 0.95 * first_dt);
  EXPECT_NEAR(time, 1e-3, 1e-15);

  // Internal and contact forces sum to exactly zero, so the error is the rounding of about 250
  // sums.
  const double exact = -0.5 * 1e4 * time * time;
  const double error = std::fabs(brick.meanDisplacement(0, 2) / exact - 1);
  printResult("shortened_step.fall", brick.meanDisplacement(0, 2), exact, error, 1e-12);
  EXPECT_LE(error, 1e-12);
  EXPECT_LE(simulation.balance().ledger_residual, 1e-12);
}

} // namespace
