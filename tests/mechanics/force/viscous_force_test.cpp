// Forces of bulk viscosity: closed form for uniform fields, none in rigid rotation, power never
// positive, the same bits for any partition, no effect on the other forces.
#include "tests/mechanics/support/block_mesh.hpp"

#include <gtest/gtest.h>

namespace brickwall::mechanics {
namespace {

using namespace testing;

const ElementKind kinds[] = {ElementKind::one_point, ElementKind::full};
constexpr BulkViscosity both = {0.06, 1.2};

Vec3 shaken(const Vec3& x) {
  const auto seed = static_cast<std::uint64_t>(1000 * x.x + 100000 * x.y + 10000000 * x.z);
  return x + 0.05 * randomVector(3 * seed);
}

using Field = std::function<Vec3(const Vec3&)>;

struct Viscous {
  std::vector<std::int64_t> forces; // [global node][12]
  double quantum, rate, power; // sum of viscous force times velocity
  std::int64_t failures;
  double force(global_id node, int i) const {
    return quantum * static_cast<double>(forces[12 * node + 3 * viscous_force + i]);
  }
};
Viscous evaluate(MPI_Comm comm, BlockMesh& blocks, const Field& displacement, const Field& velocity,
                 const BulkViscosity& viscosity, ElementKind kind, int threads = 0) {
  const exec_space space;
  const Quantum quantum = Quantum::forForceScale(forceScale(space, comm, blocks.mesh));
  InternalForce internal(space, comm, blocks.mesh, kind, quantum, testEnergyScale(), threads);
  const NodalForces forces = zeroedForces(blocks.mesh, quantum, true);
  const auto u = nodalField(space, blocks.mesh, displacement);
  const auto v = nodalField(space, blocks.mesh, velocity);
  const auto local = internal.add(space, u, v, viscosity, forces, true);
  blocks.sum.sum(space, forces.values);
  Viscous result{globalWords(comm, blocks, forces.values), quantum.value,
                 allReduce(comm, local.compression_rate, MPI_MAX), 0, local.failure.count};
  const auto velocities = globalWords(comm, blocks, v);
  for (global_id node = 0; node < blocks.num_global_nodes; ++node)
    for (int i = 0; i < 3; ++i) {
      double value;
      memcpy(&value, &velocities[3 * node + i], sizeof value);
      result.power += result.force(node, i) * value;
    }
  return result;
}

// A cube of edge h, u = e X, v = a X: F = (1 + e) I, tr D = 3 a/(1 + e), so P = rho l tr D (b1 c_d
// + b2^2 l |tr D|)/(1 + e) on every face, whose area h^2 is shared by four corners. For the linear
// material e has no effect.
TEST(BulkViscosity, OfUniformDilationIsThePressureInClosedForm) {
  constexpr double h = 0.5, e = -0.1;
  for (const MaterialModel model : all_models)
    for (const ElementKind kind : kinds)
      for (const double a : {-0.3, 0.3}) {
        const Block block{{1, 1, 1}, {h, h, h}};
        const Material material = {model, 1.7, 2.3, 0.3};
        BlockMesh blocks = makeBlocks(exec_space(), world, {block}, {material});
        const auto result = evaluate(
            world, blocks, [](const Vec3& x) { return e * x; },
            [&](const Vec3& x) { return a * x; }, both, kind);
        const double stretch = model == MaterialModel::linear ? 1 : 1 + e;
        const double trace = 3 * a / stretch, c = material.dilatationalSpeed();
        const double quadratic = a < 0 ? 1.2 * 1.2 * h * std::fabs(trace) : 0;
        const double P = 1.7 * h * trace * (0.06 * c + quadratic) / stretch;
        for (global_id node = 0; node < 8; ++node)
          for (int i = 0; i < 3; ++i) {
            const double outward = (node >> i & 1) ? 1 : -1; // grid numbering: x, y, z bits
            EXPECT_NEAR(result.force(node, i), -outward * P * h * h / 4, 1e-15);
          }
        EXPECT_NEAR(result.rate, a < 0 ? h * std::fabs(trace) / c : 0, 1e-15);
        EXPECT_EQ(result.failures, 0);
      }
}

// On any single element affine fields have the power -V P : dH/dt exactly.
TEST(BulkViscosity, OfAffineFieldsHasThePowerInClosedForm) {
  const double gradient[3][3] = {{0.1, 0.05, 0}, {-0.02, -0.15, 0.04}, {0, 0.1, 0.07}};
  const double rate[3][3] = {{-0.4, 0.1, 0.3}, {0.2, 0.1, 0}, {-0.1, 0.25, -0.2}};
  const auto apply = [](const double(&g)[3][3]) {
    return [&g](const Vec3& x) {
      Vec3 y;
      for (int i = 0; i < 3; ++i)
        y[i] = g[i][0] * x.x + g[i][1] * x.y + g[i][2] * x.z;
      return y;
    };
  };
  for (const ElementKind kind : kinds) {
    const Material material = steelLike();
    BlockMesh blocks = makeBlocks(exec_space(), world, {Block()}, {material}, shaken);
    const auto words = globalWords(world, blocks, blocks.mesh.reference_coordinates);
    CornerCoordinates X;
    const int corner_of_grid[8] = {0, 1, 3, 2, 4, 5, 7, 6};
    for (int g = 0; g < 8; ++g)
      memcpy(X[corner_of_grid[g]], &words[3 * g], sizeof X[0]);
    double modes[3][num_modes];
    coordinateModes(X, modes);
    const Mat3 jacobian = centreJacobian(modes);
    double length = HUGE_VAL;
    for (int k = 0; k < 3; ++k)
      length = std::min(length, 2 * norm(Vec3{jacobian(0, k), jacobian(1, k), jacobian(2, k)}));
    ViscousStress<double> point;
    viscousStress<MaterialModel::neo_hookean>(gradient, rate, length,
                                              ViscousModuli::of(material, both), point);
    double power = 0;
    for (int k = 0; k < 9; ++k)
      power -= hexVolume(X).volume * point.P[k / 3][k % 3] * rate[k / 3][k % 3];
    EXPECT_LT(power, -1e-3);
    const auto result = evaluate(world, blocks, apply(gradient), apply(rate), both, kind);
    EXPECT_NEAR(result.power, power, 1e-14);
    EXPECT_NEAR(result.rate, point.rate, 1e-14);
  }
}

TEST(BulkViscosity, IsZeroInRigidMotion) {
  const double angle = 2.3, c = std::cos(angle), s = std::sin(angle);
  const Vec3 spin = {0, 0, 0.7};
  const Field turned = [=](const Vec3& x) {
    return Vec3{c * x.x - s * x.y - x.x + 0.5, s * x.x + c * x.y - x.y - 0.2, 0.3};
  };
  const Field velocity = [&](const Vec3& x) {
    return cross(spin, x + turned(x)) + Vec3{0.1, 0.2, -0.3};
  };
  for (const ElementKind kind : kinds)
    for (const bool is_distorted : {false, true}) {
      BlockMesh blocks = makeBlocks(
          exec_space(), world, {cube(3)}, {steelLike()},
          [&](const Vec3& x) { return is_distorted ? shaken(x) : x; }, scattered);
      const auto result = evaluate(world, blocks, turned, velocity, both, kind);
      for (global_id node = 0; node < blocks.num_global_nodes; ++node)
        for (int i = 0; i < 3; ++i)
          EXPECT_LE(std::fabs(result.force(node, i)), 1e-16); // b1 rho c h^2 times some ulp of tr D
      EXPECT_LE(result.rate, 1e-14);
    }
}

// f . v = -(sum of w J q tr D): no element gains energy from its viscosity at the velocity at which
// it is evaluated.
TEST(BulkViscosity, NeverHasPositivePower) {
  for (const MaterialModel model : all_models)
    for (const ElementKind kind : kinds)
      for (const BulkViscosity& b : {BulkViscosity{0.06, 0}, BulkViscosity{0, 1.2}, both})
        for (int seed = 0; seed < 10; ++seed) {
          BlockMesh blocks = makeBlocks(exec_space(), world, {Block()}, {steelLike(model)}, shaken);
          const auto random = [&](double size, int salt) {
            return [=](const Vec3& x) {
              const auto at =
                  static_cast<std::uint64_t>(1000 * (seed + 100 * salt) + 10 + 8 * std::rint(x.x) +
                                             4 * std::rint(x.y) + 2 * std::rint(x.z));
              return size * randomVector(3 * at);
            };
          };
          const auto result = evaluate(world, blocks, random(0.1, 1), random(1, 2), b, kind);
          EXPECT_EQ(result.failures, 0);
          EXPECT_LE(result.power, 0);
        }
}

TEST(BulkViscosity, HasTheSameBitsForAnyPartitionAndChangesNoOtherForce) {
  const Field u = [](const Vec3& x) {
    return Vec3{0.01 * std::sin(3 * x.y), 0.02 * x.x * x.z, 0.01 * std::cos(2 * x.x)};
  };
  const Field v = [](const Vec3& x) {
    return Vec3{-0.1 * x.x + 0.02 * std::sin(5 * x.y), 0.03 * x.x * x.z, 0.05 * std::cos(4 * x.z)};
  };
  const Block small = cube(3), large{{12, 10, 9}, {1, 1, 1}, {2, 0, 0}};
  for (const ElementKind kind : kinds)
    for (const bool is_distorted : {false, true}) {
      const auto meshOn = [&](MPI_Comm comm, const Partition& partition) {
        return makeBlocks(
            exec_space(), comm, {small, large}, {steelLike()},
            [&](const Vec3& x) { return is_distorted ? shaken(0.1 * x) : x; }, partition);
      };
      BlockMesh whole_mesh = meshOn(MPI_COMM_SELF, onOneRank);
      BlockMesh cut_mesh = meshOn(world, scattered);
      const auto whole = evaluate(MPI_COMM_SELF, whole_mesh, u, v, both, kind, 1);
      const auto threads = evaluate(MPI_COMM_SELF, whole_mesh, u, v, both, kind, 4);
      const auto cut = evaluate(world, cut_mesh, u, v, both, kind);
      const auto without = evaluate(world, cut_mesh, u, v, {}, kind);
      EXPECT_EQ(whole.forces, cut.forces);
      EXPECT_EQ(whole.forces, threads.forces);
      EXPECT_EQ(whole.rate, cut.rate);
      EXPECT_GT(cut.rate, 0);
      EXPECT_EQ(without.rate, 0);
      std::int64_t largest = 0, sum[3] = {};
      for (global_id node = 0; node < cut_mesh.num_global_nodes; ++node)
        for (int column = 0; column < 12; ++column) {
          const std::int64_t with_it = cut.forces[12 * node + column];
          const std::int64_t without_it = without.forces[12 * node + column];
          if (column < 3 * viscous_force) {
            ASSERT_EQ(with_it, without_it);
            continue;
          }
          ASSERT_EQ(without_it, 0);
          largest = std::max(largest, std::abs(with_it));
          sum[column % 3] += with_it;
        }
      EXPECT_GT(largest, 1e6);
      for (const std::int64_t component : sum)
        EXPECT_EQ(component, 0); // internal force
    }
}

// A failed element adds no viscous force either; the others do.
TEST(BulkViscosity, OfAFailedElementIsNotAdded) {
  BlockMesh blocks = makeBlocks(exec_space(), world, {Block{{2, 1, 1}}}, {steelLike()});
  const auto result = evaluate(
      world, blocks,
      [](const Vec3& x) {
        return Vec3{x.x > 0.9 ? -0.7 : 0.0, 0, 0};
      },
      [](const Vec3& x) { return -0.1 * x; }, both, ElementKind::one_point);
  EXPECT_EQ(allReduce(world, result.failures, MPI_SUM), 1);
  for (global_id node = 0; node < 12; ++node)
    // nodes at x = 1 belong to that element alone
    EXPECT_EQ(result.force(node, 0) != 0, node % 3 != 2) << node;
}

} // namespace
} // namespace brickwall::mechanics
