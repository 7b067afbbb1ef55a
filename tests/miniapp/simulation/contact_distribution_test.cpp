// Faces of contact on other ranks than their elements: the same bits, whenever they move; and the
// rule by which they move.
#include "tests/miniapp/simulation/case.hpp"

#include "io/wall/hashed_random.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace {

using namespace brickwall;
using miniapp::ContactBalance;
using miniapp::StepPart;
using verification::Case;

// Bricks that slide under a growing load, with edges and friction; lists are kept.
const char* const sliding_bricks =
    "[wall]\nbricks = [2, 1, 3]\nbrick = [0.2, 0.1, 0.1]\nelements = [4, 2, 2]\n"
    "[material.brick]\ndensity = 2000\nyoungs_modulus = 20e9\npoissons_ratio = 0.2\n"
    "[[load.pressure]]\nside_set = \"front\"\npeak = 1e7\nshape = \"step\"\n"
    "[[boundary.fixed]]\nnode_set = \"base\"\n"
    "[gravity]\nacceleration = [0, 0, -9.81]\n"
    "[contact]\nfriction = 0.3\n"
    "[time]\nend = 1\n";

std::vector<int> randomRanks(const Case& wall, std::int64_t step) {
  const auto ids = toHost(wall.scene.skin.face_ids);
  const int num_ranks = sizeOf(MPI_COMM_WORLD);
  std::vector<int> ranks;
  for (int face = 0; face < wall.scene.skin.num_faces; ++face) {
    const double random = io::hashedUniform(7, ids(face), static_cast<int>(step)); // [-1, 1)
    ranks.push_back(std::min(num_ranks - 1, static_cast<int>(0.5 * (random + 1) * num_ranks)));
  }
  return ranks;
}

// Of all parts of 60 steps; faces move to random ranks, or home, before every fifth step.
std::vector<std::uint64_t> checksumsOf(const std::string& search, bool moves_faces) {
  Case wall(std::string(sliding_bricks) + search);
  std::vector<std::uint64_t> sums;
  wall.simulation.observe(
      [&](StepPart part) { sums.push_back(checksumOf(wall.simulation, part)); });
  wall.simulation.start();
  for (int step = 0; step < 60; ++step) {
    if (moves_faces && step % 5 == 3)
      wall.simulation.distributeContact(step % 10 == 3 ? randomRanks(wall, step)
                                                       : std::vector<int>());
    wall.simulation.step();
  }
  EXPECT_GT(contactCounts(wall.simulation).active, 0);
  EXPECT_EQ(contactCounts(wall.simulation).missed_pairs, 0);
  return sums;
}

TEST(ContactDistribution, ChangesNoBitWhereverFacesAreAndWheneverTheyMove) {
  for (const char* search : {"[search]\naudit = 7\n", "[search]\nreuse = { margin = 0.0 }\n"}) {
    const auto primary = checksumsOf(search, false);
    EXPECT_EQ(checksumsOf(std::string(search) + "decomposition = \"surface\"\n", false), primary);
    EXPECT_EQ(checksumsOf(std::string(search) + "decomposition = \"auto\"\n", true), primary);
  }
}

// Of all parts of 30 steps of a row of eight bricks, the first of which strikes the next one. Counts the
// steps with contact in which this rank has visited some nodes only.
std::vector<std::uint64_t> checksumsOfRow(const std::string& search, MPI_Comm comm,
                                          bool moves_faces, int& listed_steps) {
  Case row("[wall]\nbricks = [8, 1, 1]\nbrick = [0.2, 0.1, 0.1]\nelements = [8, 4, 4]\n"
           "[material.brick]\ndensity = 2000\nyoungs_modulus = 20e9\npoissons_ratio = 0.2\n"
           "[[initial.velocity]]\nbody = 0\nvelocity = [1, 0, 0]\n"
           "[time]\nend = 1\n" +
               search,
           comm);
  std::vector<std::uint64_t> sums;
  row.simulation.observe([&](StepPart part) { sums.push_back(checksumOf(row.simulation, part)); });
  row.simulation.start();
  for (int step = 0; step < 30; ++step) {
    if (moves_faces && step % 10 == 5)
      row.simulation.distributeContact(randomRanks(row, step));
    row.simulation.step();
    const auto& enforcement = row.simulation.contact()->enforcement();
    listed_steps += enforcement.hasForces() && !enforcement.touched().isAll();
  }
  return sums;
}

TEST(ContactDistribution, ChangesNoBitWhereOnlyNodesThatContactsMayActOnAreVisited) {
  int listed_steps = 0;
  const auto alone = checksumsOfRow("", MPI_COMM_SELF, false, listed_steps);
  EXPECT_GT(listed_steps, 5);
  listed_steps = 0;
  EXPECT_EQ(checksumsOfRow("", MPI_COMM_WORLD, false, listed_steps), alone);
  EXPECT_GT(allReduce(MPI_COMM_WORLD, listed_steps, MPI_MAX), 5);
  const std::string surface = "[search]\ndecomposition = \"surface\"\n";
  EXPECT_EQ(checksumsOfRow(surface, MPI_COMM_WORLD, false, listed_steps), alone);
  EXPECT_EQ(checksumsOfRow(surface, MPI_COMM_WORLD, true, listed_steps), alone);
}

TEST(ContactDistribution, GivesRanksEqualWork) {
  Case wall(std::string(sliding_bricks) + "[search]\ndecomposition = \"surface\"\n");
  const int size = sizeOf(MPI_COMM_WORLD);
  const contact::Surface surface = wall.simulation.contact()->surface();
  // Bisection cuts log2(ranks) times, each time between two rows of faces: a row has 16 of the 384.
  EXPECT_LE(miniapp::imbalanceOf(MPI_COMM_WORLD, surface.num_faces), 1 + 16. * size / 384);
}

TEST(ContactBalance, DistributesWhenWaitsHaveCostAsMuchAsADistribution) {
  const int size = sizeOf(MPI_COMM_WORLD);
  if (size == 1)
    GTEST_SKIP() << "one rank waits for nobody";
  const double work = rankOf(MPI_COMM_WORLD) == 0 ? 1 : 0; // imbalance: the number of ranks
  EXPECT_EQ(miniapp::imbalanceOf(MPI_COMM_WORLD, work), size);
  const double lost = 1 - ContactBalance::tolerated / size; // share of the time of contact
  ContactBalance balance(MPI_COMM_WORLD, 1.0);
  balance.addTime(0.9 / lost);
  EXPECT_FALSE(balance.isDue(work, work));
  balance.addTime(0.2 / lost);
  EXPECT_TRUE(balance.isDue(work, work));
  // An imbalance that stays after a distribution is no reason for another.
  balance.haveDistributed(0.1, size);
  balance.addTime(0.2 / lost);
  EXPECT_FALSE(balance.isDue(work, work));
  balance.addTime(0.2 / lost);
  EXPECT_FALSE(balance.isDue(work, work));
  EXPECT_EQ(balance.distributions(), 1);
  // Work that is balanced loses nothing.
  ContactBalance even(MPI_COMM_WORLD, 0);
  even.addTime(1e3);
  EXPECT_FALSE(even.isDue(1, 1));
}

// Work of this rank if that of all is 1 on average, and the largest is `imbalance`.
double workOf(double imbalance) {
  const int size = sizeOf(MPI_COMM_WORLD);
  return rankOf(MPI_COMM_WORLD) == 0 ? imbalance : (size - imbalance) / (size - 1);
}

TEST(ContactBalance, LeavesHomeOnlyIfBalanceGainsMoreThanMessagesUsuallyCost) {
  if (sizeOf(MPI_COMM_WORLD) == 1)
    GTEST_SKIP() << "one rank sends no message";
  for (const double imbalance : {1.4, 1.5}) { // 1.3 times 1.1 is between them
    const double work = workOf(imbalance);
    ContactBalance balance(MPI_COMM_WORLD, 1.0, ContactBalance::usual_overhead);
    balance.addTime(1e3);
    EXPECT_EQ(balance.isDue(work, work), imbalance > 1.45) << imbalance;
    EXPECT_EQ(balance.isHomeBetter(), imbalance < 1.45) << imbalance;
  }
}

TEST(ContactBalance, ReturnsHomeWhereThatIsAsBalanced) {
  if (sizeOf(MPI_COMM_WORLD) == 1)
    GTEST_SKIP() << "one rank sends no message";
  ContactBalance balance(MPI_COMM_WORLD, 1.0, ContactBalance::usual_overhead);
  balance.addTime(1e3);
  ASSERT_TRUE(balance.isDue(workOf(1.8), workOf(1.8)));
  balance.haveDistributed(1, 1, false);
  for (int check = 0; check < 10; ++check) { // the time is 0.8 of that at home
    balance.addTime(0.8e3);
    EXPECT_FALSE(balance.isDue(1, workOf(1.8)));
  }
  // Home has no imbalance now; away messages take 0.3 of the time there.
  balance.addTime(0.9 * 1.3 / 0.3);
  EXPECT_FALSE(balance.isDue(1, 1));
  balance.addTime(0.2 * 1.3 / 0.3);
  EXPECT_TRUE(balance.isDue(1, 1));
  EXPECT_TRUE(balance.isHomeBetter());
  balance.haveReturned(1);
  // That was no failure: the next imbalance is answered as the first one.
  balance.addTime(1e3);
  EXPECT_TRUE(balance.isDue(workOf(1.5), workOf(1.5)));
}

TEST(ContactBalance, ReturnsHomeFromAVainDistributionAndTheSecondTimeForGood) {
  if (sizeOf(MPI_COMM_WORLD) == 1)
    GTEST_SKIP() << "one rank sends no message";
  const auto isDueAtHome = [](ContactBalance& balance, double imbalance) {
    balance.addTime(1e3 * imbalance);
    return balance.isDue(workOf(imbalance), workOf(imbalance));
  };
  ContactBalance balance(MPI_COMM_WORLD, 1.0, ContactBalance::usual_overhead);
  ASSERT_TRUE(isDueAtHome(balance, 1.6));
  balance.haveDistributed(1, 1, false);
  balance.addTime(1.5e3); // less than 1.1 times faster than at home, in the first check
  EXPECT_TRUE(balance.isDue(1, workOf(1.6)));
  EXPECT_TRUE(balance.isHomeBetter());
  balance.haveReturned(1);
  EXPECT_DOUBLE_EQ(balance.overhead(), 1.1 * 1.6);
  EXPECT_FALSE(isDueAtHome(balance, 1.9)); // 1.1 times 1.1 times 1.6 is 1.936
  ASSERT_TRUE(isDueAtHome(balance, 1.95));
  balance.haveDistributed(1, 1, false);
  balance.addTime(1.5e3); // 1.3 times faster: faces stay
  EXPECT_FALSE(balance.isDue(1, workOf(1.95)));
  balance.haveDistributed(1, 1, false); // a later one is not compared with home
  balance.addTime(1e6);
  EXPECT_FALSE(balance.isDue(1, workOf(2)));
  balance.haveReturned(1);
  ASSERT_TRUE(isDueAtHome(balance, 1.95));
  balance.haveDistributed(1, 1, false);
  balance.addTime(1.9e3);
  EXPECT_TRUE(balance.isDue(1, workOf(1.95)));
  EXPECT_TRUE(balance.isHomeBetter());
  balance.haveReturned(1);
  const int size = sizeOf(MPI_COMM_WORLD);
  for (int check = 0; check < 10; ++check)
    EXPECT_FALSE(isDueAtHome(balance, size));
  EXPECT_EQ(balance.distributions(), 7);
}

} // namespace
