// Elements that move to other ranks during a run: the same bits, whenever and wherever they move;
// equal work after it; and the rule by which they move.
#include "tests/miniapp/simulation/case.hpp"

#include "io/wall/hashed_random.hpp"
#include "miniapp/restart/element_move.hpp"
#include "miniapp/simulation/element_balance.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <vector>

namespace {

using namespace brickwall;
using miniapp::ElementBalance;
using miniapp::Rebalance;
using miniapp::StepPart;

// Bricks that slide under a load; one of the top course is pushed against its neighbour.
const char* const pushed_bricks =
    "[wall]\nbricks = [2, 1, 3]\nbrick = [0.2, 0.1, 0.1]\nelements = [4, 2, 2]\n"
    "[material.brick]\ndensity = 2000\nyoungs_modulus = 20e9\npoissons_ratio = 0.2\n"
    "[[load.pressure]]\nside_set = \"front\"\npeak = 1e7\nshape = \"step\"\n"
    "[[boundary.fixed]]\nnode_set = \"base\"\n"
    "[[initial.velocity]]\nbrick = [0, 0, 2]\nvelocity = [20, 0, 5]\n"
    "[time]\nend = 1\n";

// A simulation whose elements may move.
struct MovingRun {
  explicit MovingRun(const std::string& deck)
      : config(miniapp::parseConfig(deck, "case.toml")),
        scene(miniapp::makeScene(exec_space(), MPI_COMM_WORLD, config)),
        simulation(std::make_unique<miniapp::Simulation>(MPI_COMM_WORLD, config, scene)) {}

  void move(const std::vector<int>& ranks) {
    simulation = moveElements(std::move(simulation), scene, ranks);
  }
  std::vector<int> randomRanks(int seed) const {
    std::vector<int> ranks;
    for (const global_id elem : scene.part.elem_ids)
      ranks.push_back(
          static_cast<int>(0.5 * (io::hashedUniform(5, elem, seed) + 1) * sizeOf(MPI_COMM_WORLD)));
    return ranks;
  }

  miniapp::Config config;
  miniapp::Scene scene;
  std::unique_ptr<miniapp::Simulation> simulation;
};

// Of all parts of 40 steps; before every fifth step elements move to random ranks, or all to the
// last.
std::vector<std::uint64_t> checksumsOfMoved(const std::string& more, bool moves) {
  MovingRun run(pushed_bricks + more);
  std::vector<std::uint64_t> sums;
  const auto observe = [&] {
    run.simulation->observe(
        [&](StepPart part) { sums.push_back(checksumOf(*run.simulation, part)); });
  };
  observe();
  run.simulation->start();
  for (int step = 0; step < 40; ++step) {
    if (moves && step % 5 == 3) {
      run.move(step % 10 == 3
                   ? run.randomRanks(step)
                   : std::vector<int>(run.scene.part.elem_ids.size(), sizeOf(MPI_COMM_WORLD) - 1));
      observe();
    }
    run.simulation->step();
  }
  EXPECT_EQ(contactCounts(*run.simulation).missed_pairs, 0);
  EXPECT_EQ(contactCounts(*run.simulation).active > 0, run.config.contact.enabled);
  return sums;
}

TEST(ElementMove, ChangesNoBitWhereverElementsAreAndWheneverTheyMove) {
  for (const char* more :
       {"[contact]\nfriction = 0.3\n[search]\naudit = 7\n[gravity]\nacceleration = [0, 0, -9.81]\n",
        "[contact]\nfriction = 0.3\n[search]\nreuse = { margin = 0.0 }\ndecomposition = "
        "\"surface\"\n",
        "[contact]\nenabled = false\n", "[viscosity]\nlinear = 0.06\nquadratic = 1.2\n"})
    EXPECT_EQ(checksumsOfMoved(more, true), checksumsOfMoved(more, false)) << more;
}

// Of all ranks: contacts of nodes, of edges, and areas in flush joints.
std::array<std::int64_t, 3> numRecords(const miniapp::Simulation& simulation) {
  const miniapp::ContactRestart data = simulation.restartData().contact;
  std::array<std::int64_t, 3> counts = {static_cast<std::int64_t>(data.nodes.size()),
                                        static_cast<std::int64_t>(data.edges.size()),
                                        static_cast<std::int64_t>(data.joints.size())};
  allReduce(MPI_COMM_WORLD, counts.data(), 3, MPI_SUM);
  return counts;
}

TEST(ElementMove, KeepsEachContactAndJointOnce) {
  MovingRun run(pushed_bricks);
  run.simulation->start();
  run.simulation->step();
  miniapp::SimulationRestart data = run.simulation->restartData();
  for (const contact::ContactRecord& record : data.contact.nodes) // these meshes match: no joints
    data.contact.joints.push_back({record.node, record.pair.side, 1e-4});
  run.simulation->restore(data);
  const auto before = numRecords(*run.simulation);
  EXPECT_GT(before[2], 0);
  for (int seed = 1; seed <= 3; ++seed) {
    run.move(run.randomRanks(seed));
    EXPECT_EQ(numRecords(*run.simulation), before) << seed;
  }
}

TEST(ElementBalance, MovesElementsToRanksOfEqualWorkAsSoonAsThatPays) {
  const int size = sizeOf(MPI_COMM_WORLD);
  if (size == 1)
    GTEST_SKIP() << "there is no other rank";
  MovingRun run(std::string(pushed_bricks) + "[contact]\nenabled = false\n");
  run.simulation->start();
  run.move(std::vector<int>(run.scene.part.elem_ids.size(), 0));
  const double works = rankOf(MPI_COMM_WORLD) == 0 ? 1 : 0;
  ElementBalance balance(MPI_COMM_WORLD, {Rebalance::automatic, 2}, 1.0);
  run.simulation->step();
  EXPECT_FALSE(balance.newRanks(*run.simulation, {9, 9 * works, 0})); // between checks
  run.simulation->step();
  // Rank 0 alone works, so the imbalance is the number of ranks.
  const double lost = 1 - miniapp::ContactBalance::tolerated / size; // share of the time of a step
  EXPECT_FALSE(balance.newRanks(*run.simulation, {0.9 / lost, 0.9 * works, 0}));
  const auto ranks = balance.newRanks(*run.simulation, {1.1 / lost, 1.1 * works, 0});
  ASSERT_TRUE(ranks);
  run.move(*ranks);
  balance.haveMoved(0.5, {2, 2 * works, 0});
  // Each of log2(ranks) bisections lies between two layers of the 96 elements, at most 8 elements
  // each.
  EXPECT_LE(miniapp::imbalanceOf(MPI_COMM_WORLD, run.scene.part.numElems()), 1 + 8. * size / 96);
  EXPECT_FALSE(balance.newRanks(*run.simulation, {9, 9, 0}));
  ASSERT_EQ(balance.rebalancings().size(), 1u);
  const miniapp::Rebalancing& done = balance.rebalancings().front();
  EXPECT_EQ(done.step, 2);
  EXPECT_EQ(done.seconds, 0.5);
  EXPECT_NEAR(done.imbalance_before, size, 1e-12);
  EXPECT_NEAR(done.imbalance_after, miniapp::imbalanceOf(MPI_COMM_WORLD, run.scene.part.numElems()),
              1e-12);
}

TEST(ElementBalance, WhileAllBodiesRestRanksGetEqualNumbersOfElements) {
  const int size = sizeOf(MPI_COMM_WORLD);
  if (size == 1)
    GTEST_SKIP() << "there is no other rank";
  MovingRun run("[wall]\nbricks = [2, 1, 3]\nbrick = [0.2, 0.1, 0.1]\nelements = [4, 2, 2]\n"
                "[material.brick]\ndensity = 2000\nyoungs_modulus = 20e9\npoissons_ratio = 0.2\n"
                "[time]\nend = 1\n");
  run.simulation->start();
  run.move(std::vector<int>(run.scene.part.elem_ids.size(), 0));
  ElementBalance balance(MPI_COMM_WORLD, {Rebalance::always, 1}, 1.0);
  run.simulation->step();
  const auto ranks = balance.newRanks(*run.simulation, {1, 0, 0});
  ASSERT_TRUE(ranks);
  run.move(*ranks);
  EXPECT_LE(miniapp::imbalanceOf(MPI_COMM_WORLD, run.scene.part.numElems()), 1 + 8. * size / 96);
}

} // namespace
