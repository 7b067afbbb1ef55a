// V15 and V14 of shared/physics.md: a wall that is its own mirror image, under a load that is too, stays so; and the
// impulse of the load is the change of momentum.
#include "case.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

namespace {

using brickwall::verification::Case;
using brickwall::verification::printResult;

// Displacements of all ranks by reference position: equal positions (two bricks that touch) keep the order of ids.
using Field = std::vector<std::array<double, 6>>; // X, u

Field gather(const Case& wall) {
  const auto u = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(),
                                                     wall.simulation.state().displacement);
  std::vector<std::vector<std::array<double, 6>>> sent(brickwall::sizeOf(MPI_COMM_WORLD));
  for (int node = 0; node < wall.scene.mesh.num_nodes; ++node)
    if (wall.scene.node_is_owned[node]) {
      const double* X = &wall.scene.part.coordinates[3 * node];
      sent[0].push_back({X[0], X[1], X[2], u(node, 0), u(node, 1), u(node, 2)});
    }
  Field field;
  for (const auto& list : brickwall::exchangeByRank(MPI_COMM_WORLD, sent))
    field.insert(field.end(), list.begin(), list.end());
  return field;
}

TEST(MirrorSymmetricWall, StaysSymmetricAndBalancesTheImpulseOfThePulse) {
  const double brick = 0.2, length = 4 * brick;
  Case wall("[wall]\nbricks = [4, 1, 4]\nbrick = [0.2, 0.1, 0.1]\nelements = [4, 2, 2]\n"
            "[material.brick]\ndensity = 2000\nyoungs_modulus = 20e9\npoissons_ratio = 0.2\n"
            "[[load.pressure]]\nside_set = \"front\"\nshape = \"half_sine\"\npeak = 2e6\nduration "
            "= 2e-3\n"
            "[[boundary.fixed]]\nnode_set = \"base_course\"\n"
            "[time]\nend = 2.5e-3\n");
  auto& simulation = wall.simulation;
  simulation.start();
  while (!simulation.done())
    simulation.step();

  const auto& balance = simulation.balance();
  printResult("V14.momentum", balance.momentum_error, 0, balance.momentum_error, 1e-12);
  EXPECT_LE(balance.momentum_error, 1e-12);
  EXPECT_LE(balance.ledger_residual, 1e-12);

  const Field field = gather(wall);
  double largest = 0, worst = 0;
  // Neighbouring bricks have nodes at the same place: compare sums over a place, which mirror as well.
  std::map<std::array<long, 3>, std::array<double, 3>> sums;
  const auto key = [](double x, double y, double z) {
    return std::array<long, 3>{std::lround(x * 1e6), std::lround(y * 1e6), std::lround(z * 1e6)};
  };
  for (const auto& row : field) {
    auto& sum = sums[key(row[0], row[1], row[2])];
    for (int d = 0; d < 3; ++d) {
      sum[d] += row[3 + d];
      largest = std::fmax(largest, std::fabs(row[3 + d]));
    }
  }
  for (const auto& row : field) {
    const auto& here = sums[key(row[0], row[1], row[2])];
    const auto& mirror = sums[key(length - row[0], row[1], row[2])];
    worst = std::fmax(worst, std::fabs(here[0] + mirror[0]));
    worst = std::fmax(worst, std::fabs(here[1] - mirror[1]));
    worst = std::fmax(worst, std::fabs(here[2] - mirror[2]));
  }
  if (brickwall::rankOf(MPI_COMM_WORLD) == 0) {
    EXPECT_GT(largest, 1e-3); // it has moved
    // Relative to a brick: penetrations are differences of positions x = X + u, so their rounding is that of the wall's
    // size, 1e-16 m here, whatever the displacements are.
    printResult("V15.symmetry", worst / brick, 0, worst / brick, 1e-10);
    EXPECT_LE(worst, 1e-10 * brick);
  }
}

} // namespace
