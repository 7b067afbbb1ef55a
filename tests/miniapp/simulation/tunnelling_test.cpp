// A brick so fast (v/c = 0.8) that it moves by half its length in a stable step. The tunnelling
// guard must detect the contact, and its only effect may be a shorter step: the ledger closes, free
// flight is exact, and the bits depend neither on the number of ranks nor on whether lists of
// candidates are kept.
#include "contact/base/to_device.hpp"
#include "tests/miniapp/simulation/case.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <map>

namespace {

using brickwall::PhysicsError;
using brickwall::toHost;
using brickwall::verification::Case;
using brickwall::verification::printResult;

// Two cubes of side 1 with a gap of 0.3 and the wave speed c = 1; the left one flies towards the
// right one. Contact is so soft that the step is that of free cubes. `more` holds keys of
// [contact], then further blocks.
std::string thrown(double speed, const std::string& more = "") {
  return "[wall]\nbricks = [2, 1, 1]\nbrick = [1, 1, 1]\nelements = [1, 1, 1]\ngap = 0.3\nends = "
         "\"ragged\"\n[material.brick]\ndensity = 1\nyoungs_modulus = 1\npoissons_ratio = 0\n"
         "[[initial.velocity]]\nbrick = [0, 0, 0]\nvelocity = [" +
         std::to_string(speed) +
         ", 0, 0]\n[time]\nend = 4.0\nsafety = 0.8\n[contact]\npenalty = 0.5\n" + more;
}
const double fast = 0.625; // half a brick in a step of 0.8

void run(Case& bricks) {
  bricks.simulation.start();
  while (!bricks.simulation.isDone())
    bricks.simulation.step();
}

// Displacement and velocity by global node.
std::map<std::int64_t, std::array<double, 6>> stateOf(const Case& bricks) {
  const auto& state = bricks.simulation.state();
  const auto u = toHost(state.displacement);
  const auto v = toHost(state.velocity);
  std::map<std::int64_t, std::array<double, 6>> values;
  for (int node = 0; node < bricks.scene.mesh.num_nodes; ++node)
    for (int d = 0; d < 3; ++d) {
      auto& row = values[bricks.scene.part.node_ids[node]];
      row[d] = u(node, d);
      row[3 + d] = v(node, d);
    }
  return values;
}

// Counts launches of the kernel over pairs.
int pair_kernels = 0;
void countKernel(const char* name, std::uint32_t, std::uint64_t*) {
  pair_kernels += std::strcmp(name, "contact::FastestPair::find") == 0;
}
struct KernelCounter {
  KernelCounter() {
    pair_kernels = 0;
    Kokkos::Tools::Experimental::set_begin_parallel_reduce_callback(countKernel);
  }
  ~KernelCounter() { Kokkos::Tools::Experimental::set_begin_parallel_reduce_callback(nullptr); }
};

TEST(TunnellingGuard, DetectsABrickThatMovesByHalfItsLengthInAStep) {
  Case bricks(thrown(fast));
  auto& simulation = bricks.simulation;
  EXPECT_NEAR(simulation.clock().dt * fast, 0.5, 1e-12);
  run(bricks);
  const auto& balance = simulation.balance();
  // Equal bodies exchange their momenta, except for the part that becomes vibration.
  printResult("tunnelling.swap", bricks.momentum(1, 0), fast,
              std::fabs(bricks.momentum(1, 0) / fast - 1), 0.1);
  EXPECT_LT(std::fabs(bricks.momentum(1, 0) / fast - 1), 0.1);
  printResult("tunnelling.momentum", balance.momentum_error, 0, balance.momentum_error, 1e-13);
  EXPECT_LE(balance.momentum_error, 1e-13);
  EXPECT_LE(balance.angular_momentum_error, 1e-13);
  EXPECT_LE(balance.ledger_residual, 1e-12);
  printResult("tunnelling.energy", balance.energy_error, 0, balance.energy_error, 2e-3);
  EXPECT_LE(balance.energy_error, 2e-3);
  EXPECT_EQ(contactCounts(simulation).lost, 0);
  ASSERT_EQ(simulation.steps().cuts().size(), 1u);
  EXPECT_EQ(simulation.steps().cuts()[0].reason, brickwall::miniapp::StepCut::Reason::tunnelling);
}

TEST(TunnellingGuard, LetsTheBrickBounceOffAFixedWall) {
  Case bricks(thrown(fast, "[[boundary.fixed]]\nnode_set = \"right_end\"\n"));
  run(bricks);
  const auto& balance = bricks.simulation.balance();
  EXPECT_LT(bricks.momentum(0, 0), -0.8 * fast);
  EXPECT_LE(balance.momentum_error, 1e-13); // the reactions included
  EXPECT_LE(balance.ledger_residual, 1e-12);
  EXPECT_LE(balance.energy_error, 2e-3);
}

// Without the guard, a brick that moves by 1.6 of its length in a step is found on the far side of
// the other brick, too deep to be pushed back without creating energy.
TEST(TunnellingGuard, IsNeededForFastBricks) {
  Case bricks(thrown(3.2 * fast, "guard = \"off\"\n[limits]\ncontact_error = 10\n"));
  run(bricks);
  EXPECT_GT(gauges(bricks.simulation)[brickwall::miniapp::gauge_contact], 0.1);
  EXPECT_TRUE(bricks.simulation.steps().cuts().empty());
  Case guarded(thrown(3.2 * fast, "tolerance = 0.25\n"));
  run(guarded);
  EXPECT_LT(gauges(guarded.simulation)[brickwall::miniapp::gauge_contact], 0.02);
  EXPECT_FALSE(guarded.simulation.steps().cuts().empty());
}

std::string errorOfStep(Case& bricks) {
  try {
    bricks.simulation.step();
  } catch (const PhysicsError& error) {
    return error.what();
  }
  return "";
}

TEST(TunnellingGuard, StopsInThePreviousStateAndNamesThePair) {
  Case bricks(
      thrown(0.15, "guard = \"stop\"\nedges = false\n[gravity]\nacceleration = [0, 0.01, 0.02]\n"));
  auto& simulation = bricks.simulation;
  simulation.start();
  auto before = stateOf(bricks);
  std::int64_t step = 0;
  double time = 0;
  std::string message;
  while (message.empty() && step < 10) { // each moves by 0.12, until the bricks may meet
    before = stateOf(bricks);
    step = simulation.clock().step;
    time = simulation.clock().time;
    message = errorOfStep(bricks);
  }
  for (const char* part : {"node ", "of body 0", "of body 1", "moves by 0.12 against face ",
                           "in one step; contact is reliable up to 0.05. "})
    EXPECT_NE(message.find(part), std::string::npos) << message;
  EXPECT_GT(step, 0);
  EXPECT_EQ(simulation.clock().step, step);
  EXPECT_EQ(simulation.clock().time, time);
  EXPECT_EQ(stateOf(bricks), before);
}

// At 1000 times the speed of sound even a thousandth of the stable step is too long.
TEST(TunnellingGuard, StopsIfTheStepWouldBecomeTooShort) {
  Case bricks(thrown(1000, "tolerance = 0.45\n"));
  bricks.simulation.start();
  const std::string message = errorOfStep(bricks);
  EXPECT_NE(message.find("below 1/1000 of the stable one"), std::string::npos) << message;
}

TEST(TunnellingGuard, LaunchesNoKernelIfNothingIsFast) {
  const KernelCounter counter;
  {
    Case bricks(thrown(0.02, ""));
    run(bricks);
    EXPECT_EQ(bricks.simulation.guardedSteps(), 0);
  }
  EXPECT_EQ(pair_kernels, 0);
  { // both bricks are fast, but not relative to each other
    Case bricks(thrown(fast, "[[initial.velocity]]\nvelocity = [10, 0, 0]\n"));
    run(bricks);
  }
  EXPECT_EQ(pair_kernels, 0);
  {
    Case bricks(thrown(fast));
    run(bricks);
    EXPECT_GT(bricks.simulation.guardedSteps(), 0);
  }
  EXPECT_GT(pair_kernels, 0);
}

// Two heavy bricks fall on a light one that is at rest and is skipped in the step. The mean
// velocity is that of the heavy bricks, and relative to it the light one is fast.
TEST(TunnellingGuard, TestsBodiesAtRest) {
  const std::string deck =
      "[wall]\nbricks = [1, 1, 2]\nbrick = [2, 1, 1]\nelements = [2, 1, 1]\ngap = 0.3\n"
      "[material.brick]\ndensity = 1\nyoungs_modulus = 1\npoissons_ratio = 0\n"
      "[material.half_brick]\ndensity = 1e4\nyoungs_modulus = 1e4\npoissons_ratio = 0\n"
      "[[initial.velocity]]\nblock = \"half_brick\"\nvelocity = [0, 0, -0.625]\n"
      "[time]\nend = 1.0\nsafety = 0.8\n[limits]\nenergy_error = 10\n[skip]\nresting_bodies = ";
  Case resting(deck + "true\n"), all(deck + "false\n");
  EXPECT_GT(specialElements(resting.simulation).resting, 0);
  EXPECT_EQ(specialElements(all.simulation).resting, 0);
  run(resting);
  run(all);
  EXPECT_GT(all.simulation.guardedSteps(), 0);
  EXPECT_EQ(resting.simulation.guardedSteps(), all.simulation.guardedSteps());
  EXPECT_EQ(stateOf(resting), stateOf(all));
}

// Under gravity the centre falls by exactly g t^2/2, although a kick was made for a longer step.
TEST(TunnellingGuard, LeavesFreeFallExact) {
  Case bricks(thrown(fast, "[gravity]\nacceleration = [0, 0, -0.05]\n"));
  run(bricks);
  ASSERT_EQ(bricks.simulation.steps().cuts().size(), 1u);
  const double time = bricks.simulation.clock().time;
  double fall = 0;
  for (int body = 0; body < 2; ++body)
    fall += 0.5 * bricks.meanDisplacement(body, 2);
  const double exact = -0.5 * 0.05 * time * time, error = std::fabs(fall / exact - 1);
  printResult("tunnelling.fall", fall, exact, error, 1e-12);
  EXPECT_LE(error, 1e-12);
  EXPECT_LE(bricks.simulation.balance().angular_momentum_error, 1e-12);
}

TEST(TunnellingGuard, DecidesTheSameOnAnyNumberOfRanksAndWithAnyMargin) {
  const std::string deck =
      "[wall]\nbricks = [2, 1, 2]\nbrick = [1, 0.5, 0.5]\nelements = [4, 2, 2]\ngap = 0.1\n"
      "ends = \"ragged\"\n[material.brick]\ndensity = 1\nyoungs_modulus = 1\npoissons_ratio = "
      "0.2\n[[initial.velocity]]\nbrick = [0, 0, 0]\nvelocity = [0.3, 0.01, 0.1]\n"
      "[[initial.velocity]]\nbrick = [1, 0, 1]\nvelocity = [-0.1, 0, -0.3]\n"
      "[contact]\ntolerance = 0.1\n[time]\nend = 3.0\n";
  const std::string every_step = deck + "[search.reuse]\nmargin = 0.0\n";
  Case whole(every_step, MPI_COMM_SELF), cut(every_step);
  Case kept(deck + "[search.reuse]\nmargin = 0.5\n");
  for (Case* bricks : {&whole, &cut, &kept})
    run(*bricks);
  const auto expected = stateOf(whole);
  for (const Case* bricks : {&cut, &kept}) {
    ASSERT_EQ(bricks->simulation.steps().cuts().size(), whole.simulation.steps().cuts().size());
    for (const auto& [node, row] : stateOf(*bricks))
      EXPECT_EQ(row, expected.at(node)) << "node " << node;
  }
  EXPECT_GT(whole.simulation.steps().cuts().size(), 0u);
  EXPECT_LT(contactCounts(kept.simulation).searches, contactCounts(cut.simulation).searches);
  EXPECT_LE(whole.simulation.balance().ledger_residual, 1e-12);
}

} // namespace
