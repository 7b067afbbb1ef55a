// Pressure on faces: nodal loads, arrival, balance on closed surfaces, end of the pulse.
#include "mechanics/loads/pressure_load.hpp"
#include "mechanics/mesh/skin.hpp"
#include "tests/mechanics/support/block_mesh.hpp"
#include "tests/mechanics/support/quad_loads.hpp"

#include <gtest/gtest.h>

namespace brickwall::mechanics {
namespace {

// Ten-point Gauss in each direction integrates the biquadratic integrand to rounding.
Vec3 byQuadrature(const Vec3 (&x)[4], int corner) {
  const double node[5] = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244,
                          0.8650633666889845, 0.9739065285171717};
  const double weight[5] = {0.2955242247147529, 0.2692667193099963, 0.2190863625159820,
                            0.1494513491505806, 0.0666713443086881};
  const double cx[4] = {-1, 1, 1, -1}, ce[4] = {-1, -1, 1, 1};
  Vec3 sum;
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j) {
      const double xi = i < 5 ? node[i] : -node[i - 5], eta = j < 5 ? node[j] : -node[j - 5];
      Vec3 a, b;
      for (int c = 0; c < 4; ++c) {
        a += (0.25 * cx[c] * (1 + ce[c] * eta)) * x[c];
        b += (0.25 * ce[c] * (1 + cx[c] * xi)) * x[c];
      }
      sum +=
          (0.25 * (1 + cx[corner] * xi) * (1 + ce[corner] * eta) * weight[i % 5] * weight[j % 5]) *
          cross(a, b);
    }
  return sum;
}

TEST(Pressure, LoadsOnAWarpedQuadrilateralAreTheIntegrals) {
  Vec3 x[4] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, load[4];
  for (int c = 0; c < 4; ++c)
    for (int j = 0; j < 3; ++j)
      x[c][j] += 0.3 * randomOf(3 * c + j);
  Pressure pressure;
  pressure.peak = 2;
  testing::quadLoads(MeanPressure(pressure, {}), x, x, load);
  for (int c = 0; c < 4; ++c) {
    const Vec3 expected = -2.0 * byQuadrature(x, c);
    for (int j = 0; j < 3; ++j)
      EXPECT_NEAR(load[c][j], expected[j], 1e-15);
  }
}

TEST(Pressure, GaussianArrivesLaterFartherAway) {
  Pressure pressure;
  pressure.peak = 3;
  pressure.shape = {PulseKind::step, 1.0};
  pressure.gaussian = true;
  pressure.radius = 2;
  pressure.speed = 10;
  const Vec3 away = {5, 0, 0};
  EXPECT_EQ(MeanPressure(pressure, {0.3, 0.49}).at(away), 0);
  EXPECT_DOUBLE_EQ(MeanPressure(pressure, {0.51, 0.51}).at(away), 3 * std::exp(-0.5 * 6.25));
  EXPECT_DOUBLE_EQ(MeanPressure(pressure, {0.25, 0.75}).at(away), 1.5 * std::exp(-0.5 * 6.25));
  EXPECT_DOUBLE_EQ(MeanPressure(pressure, {0, 0}).at({0, 0, 0}), 3);
}

TEST(Pressure, IsZeroBeforeItsStartUnlessItIsConstantAndWithoutAPeak) {
  Pressure pressure;
  pressure.start = 2;
  pressure.gaussian = true;
  pressure.radius = 2;
  for (const double speed : {10.0, HUGE_VAL}) {
    pressure.peak = 3;
    pressure.speed = speed;
    pressure.shape = {PulseKind::half_sine, 1.0};
    EXPECT_TRUE(MeanPressure(pressure, {1.7, 1.9}).isZero());
    EXPECT_FALSE(MeanPressure(pressure, {1.9, 2.1}).isZero());
    EXPECT_FALSE(MeanPressure(pressure, {2.4, 2.5}).isZero());
    pressure.shape.kind = PulseKind::constant;
    EXPECT_FALSE(MeanPressure(pressure, {1.7, 1.9}).isZero());
    pressure.peak = 0;
    EXPECT_TRUE(MeanPressure(pressure, {2.4, 2.5}).isZero());
  }
}

// The corners of all faces, face by face.
std::vector<int> cornersOf(const Skin& skin) {
  const auto faces = toHost(skin.face_to_nodes);
  std::vector<int> nodes;
  for (int f = 0; f < skin.num_faces; ++f)
    for (int c = 0; c < 4; ++c)
      nodes.push_back(faces(f, c));
  return nodes;
}

// Pressure on a closed surface exerts no force: the follower loads of all faces of a deformed block
// sum to zero up to one rounding to the quantum per corner load.
TEST(Pressure, OnAClosedSurfaceBalances) {
  const exec_space space;
  const testing::Block block{{3, 2, 2}};
  auto blocks = testing::makeBlocks(space, MPI_COMM_WORLD, {block}, {testing::steelLike()});
  const auto u = testing::nodalField(space, blocks.mesh, [](const Vec3& x) {
    return Vec3{0.2 * x.y * x.z, 0.1 * std::sin(3 * x.x), 0.3 * x.x * x.y};
  });
  const Skin skin = findSkin(space, MPI_COMM_WORLD, blocks.mesh, blocks.shared);
  const std::vector<int> nodes = cornersOf(skin);
  Pressure pressure;
  pressure.peak = 1e-3;
  const NodalForces forces = testing::zeroedForces(blocks.mesh, Quantum::powerOfTwo(-54));
  EXPECT_EQ(PressureLoad(space, MPI_COMM_WORLD, blocks.mesh, pressure, nodes)
                .add(space, blocks.mesh, u, {}, forces),
            0);
  blocks.sum.sum(space, forces.values);
  const auto all = testing::globalWords(MPI_COMM_WORLD, blocks, forces.values);
  for (int i = 0; i < 3; ++i) {
    std::int64_t sum = 0, largest = 0;
    for (global_id node = 0; node < blocks.num_global_nodes; ++node) {
      sum += all[9 * node + 3 * external_force + i];
      largest = std::max(largest, std::abs(all[9 * node + 3 * external_force + i]));
    }
    EXPECT_GT(largest, 1e10);
    EXPECT_LE(std::abs(sum), 500); // 32 faces x 4 corners, a few ulp of loads of 2^41 quanta each
  }
  pressure.follower = false;
  pressure.peak = HUGE_VAL;
  const std::int64_t misfits = PressureLoad(space, MPI_COMM_WORLD, blocks.mesh, pressure, nodes)
                                   .add(space, blocks.mesh, u, {}, forces);
  EXPECT_EQ(misfits, 4 * skin.num_faces); // infinite loads are counted, not added
}

// A wave on a deformed block: the loads of packs of faces, summed by node, have the bits of those
// of single faces.
TEST(Pressure, InPacksIsThatOfEachFace) {
  const exec_space space;
  const testing::Block block{{5, 3, 2}};
  auto blocks = testing::makeBlocks(space, MPI_COMM_SELF, {block}, {testing::steelLike()},
                                    testing::asIs, testing::onOneRank);
  const auto u = testing::nodalField(space, blocks.mesh, [](const Vec3& x) {
    return Vec3{0.2 * x.y * x.z, 0.1 * x.x, 0.3 * x.x * x.y};
  });
  const Skin skin = findSkin(space, MPI_COMM_SELF, blocks.mesh, blocks.shared);
  const auto faces = toHost(skin.face_to_nodes);
  const auto X = toHost(blocks.mesh.reference_coordinates), displacement = toHost(u);
  const std::vector<int> nodes = cornersOf(skin);
  Pressure pressure;
  pressure.peak = 1e-3;
  pressure.shape = {PulseKind::half_sine, 2.0};
  for (const bool gaussian : {false, true})
    for (const double speed : {1.0, HUGE_VAL}) {
      pressure.gaussian = gaussian;
      pressure.follower = gaussian;
      pressure.radius = 0.5;
      pressure.speed = speed;
      const TimeSpan span = {0.4, 0.5};
      const NodalForces forces = testing::zeroedForces(blocks.mesh, Quantum::powerOfTwo(-54));
      const PressureLoad load(space, MPI_COMM_WORLD, blocks.mesh, pressure, nodes);
      EXPECT_TRUE(load.acts(span));
      EXPECT_EQ(load.add(space, blocks.mesh, u, span, forces), 0);
      std::vector<std::int64_t> expected(3 * blocks.mesh.num_nodes, 0);
      for (int f = 0; f < skin.num_faces; ++f) {
        Vec3 reference[4], current[4], loads[4];
        for (int c = 0; c < 4; ++c) {
          reference[c] = rowOf(X, faces(f, c));
          current[c] =
              pressure.follower ? reference[c] + rowOf(displacement, faces(f, c)) : reference[c];
        }
        testing::quadLoads(MeanPressure(pressure, span), reference, current, loads);
        for (int c = 0; c < 4; ++c)
          for (int i = 0; i < 3; ++i)
            expected[3 * faces(f, c) + i] += roundToFixed(forces.quantum.inverse * loads[c][i]);
      }
      const auto values = toHost(forces.values);
      for (int node = 0; node < blocks.mesh.num_nodes; ++node)
        for (int i = 0; i < 3; ++i)
          EXPECT_EQ(values(node, 3 * external_force + i), expected[3 * node + i]);
    }
}

// The load is skipped only when it is exactly zero.
TEST(Pressure, EndsAfterThePulseHasPassedTheFarthestFace) {
  const exec_space space;
  const auto blocks =
      testing::makeBlocks(space, MPI_COMM_SELF, {testing::cube(2)}, {testing::steelLike()});
  const Skin skin = findSkin(space, MPI_COMM_SELF, blocks.mesh, blocks.shared);
  const auto faces = toHost(skin.face_to_nodes);
  const auto X = toHost(blocks.mesh.reference_coordinates);
  std::vector<int> nodes;
  double farthest = 0;
  Pressure pressure;
  pressure.peak = 1e-3;
  pressure.start = 0.5;
  pressure.shape.kind = PulseKind::step;
  pressure.shape.duration = 2;
  pressure.gaussian = true;
  pressure.radius = 1;
  pressure.speed = 0.25;
  for (int f = 0; f < skin.num_faces; ++f)
    for (int c = 0; c < 4; ++c) {
      nodes.push_back(faces(f, c));
      farthest = std::max(farthest, norm(rowOf(X, faces(f, c)) - pressure.centre));
    }
  const PressureLoad load(space, MPI_COMM_WORLD, blocks.mesh, pressure, nodes);
  EXPECT_NEAR(load.end(), 2.5 + 4 * farthest, 1e-10);
  const auto sizeAt = [&](double time) {
    double size = 0;
    for (int f = 0; f < skin.num_faces; ++f) {
      Vec3 corners[4], loads[4];
      for (int c = 0; c < 4; ++c)
        corners[c] = rowOf(X, faces(f, c));
      testing::quadLoads(MeanPressure(pressure, {time, time + 0.1}), corners, corners, loads);
      for (const Vec3& corner : loads)
        size += norm(corner);
    }
    return size;
  };
  EXPECT_EQ(sizeAt(load.end()), 0);
  EXPECT_TRUE(load.acts({0.9 * load.end(), load.end() + 1}));
  EXPECT_FALSE(load.acts({1.001 * load.end(), load.end() + 1}));
  EXPECT_GT(sizeAt(2.5 + 0.7 * 4 * farthest), 0);
  pressure.shape.kind = PulseKind::constant;
  EXPECT_EQ(PressureLoad(space, MPI_COMM_WORLD, blocks.mesh, pressure, nodes).end(), HUGE_VAL);
}

} // namespace
} // namespace brickwall::mechanics
