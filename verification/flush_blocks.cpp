// Offset blocks with flush coplanar faces: bricks in running
// bond, pressed together. The side faces of neighbours lie in one plane with top and bottom edges of others; without
// friction nothing may push along the joint's plane.
#include "case.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using brickwall::verification::Case;

// Two courses of running bond; the upper course moves down onto the lower one.
TEST(FlushBlocks, PressedCoursesFeelNoForceAlongTheBedJoint) {
  Case wall("[wall]\nbricks = [2, 1, 2]\nbrick = [2.0, 1.0, 1.0]\nelements = [8, 4, 4]\nends = "
            "\"ragged\"\n"
            "[material.brick]\nmodel = \"neo_hookean\"\ndensity = 1\nyoungs_modulus = "
            "1\npoissons_ratio = 0\n"
            "[[initial.velocity]]\nbrick = [0, 0, 1]\nvelocity = [0, 0, -1e-3]\n"
            "[[initial.velocity]]\nbrick = [1, 0, 1]\nvelocity = [0, 0, -1e-3]\n"
            "[time]\nend = 6.0\n");
  auto& simulation = wall.simulation;
  simulation.start();
  double largest_normal = 0, largest_across = 0;
  while (!simulation.done()) {
    simulation.step();
    for (int body = 0; body < 4; ++body) {
      largest_across = std::fmax(largest_across, std::fabs(wall.contactForce(body, 1)));
      largest_normal = std::fmax(largest_normal, std::fabs(wall.contactForce(body, 2)));
    }
  }
  EXPECT_GT(largest_normal, 1e-4);
  // Nothing leans in y: contact normals have no y component but for the rotation of bulging faces, which is symmetric,
  // so forces on a body cancel to rounding.
  EXPECT_LE(largest_across, 1e-12 * largest_normal);
  EXPECT_LE(simulation.balance().ledger_residual, 1e-12);
  EXPECT_LE(simulation.balance().energy_error, 0.02);
}

TEST(FlushBlocks, ARestingWallStaysAtRestToTheLastBit) {
  Case wall("[wall]\nbricks = [3, 2, 3]\nbrick = [0.2, 0.1, 0.1]\nelements = [4, 2, 2]\n"
            "[material.brick]\ndensity = 2000\nyoungs_modulus = 20e9\npoissons_ratio = 0.2\n"
            "[time]\nend = 1e-3\n");
  auto& simulation = wall.simulation;
  simulation.start();
  while (!simulation.done())
    simulation.step();
  const auto u =
      Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), simulation.state().displacement);
  for (int node = 0; node < wall.scene.mesh.num_nodes; ++node)
    for (int d = 0; d < 3; ++d)
      ASSERT_EQ(u(node, d), 0.0);
}

} // namespace
