// The stable time step by the element bound against the largest eigenvalue of one element.
#include "mechanics/stability/stable_time_step.hpp"

#include "mechanics/element/symmetric_eigenvalue.hpp"
#include "mechanics/mesh/recent_results.hpp"
#include "tests/mechanics/support/block_mesh.hpp"
#include "tests/mechanics/support/element_force.hpp"

#include <gtest/gtest.h>

namespace brickwall::mechanics {
namespace {

using namespace testing;

// Stiffness of one element by differences of forces; the largest eigenvalue of K/m is omega^2.
template <class Evaluate>
double trueStep(const CornerCoordinates& X, double density, const Evaluate& evaluate) {
  double K[24][24];
  const double mass = density * hexVolume(X).volume / 8;
  for (int k = 0; k < 24; ++k) {
    CornerCoordinates u = {}, down = {};
    u[k / 3][k % 3] = 0.5;
    down[k / 3][k % 3] = -0.5;
    const ElementForce plus = evaluate(u), minus = evaluate(down);
    for (int r = 0; r < 24; ++r)
      K[r][k] = (minus.force[r / 3][r % 3] - plus.force[r / 3][r % 3]) / mass;
  }
  for (int r = 0; r < 24; ++r)
    for (int c = 0; c < r; ++c)
      K[r][c] = K[c][r] = 0.5 * (K[r][c] + K[c][r]);
  return 2 / std::sqrt(largestEigenvalue(K));
}

double boundOf(const CornerCoordinates& X, const Material& material) {
  const exec_space space;
  BlockMesh one = makeBlocks(space, MPI_COMM_SELF, {Block()}, {material});
  const auto host = Kokkos::create_mirror_view(one.mesh.reference_coordinates);
  const int corner_of_grid[8] = {0, 1, 3, 2, 4, 5, 7, 6};
  for (int g = 0; g < 8; ++g)
    for (int j = 0; j < 3; ++j)
      host(g, j) = X[corner_of_grid[g]][j];
  Kokkos::deep_copy(one.mesh.reference_coordinates, host);
  return stableTimeStep(space, MPI_COMM_SELF, one.mesh).dt;
}

// The linear material's hourglass force is not linear in u (q = Q F^T g), so displacements are
// scaled down.
template <class Evaluate>
auto scaledDown(const Evaluate& evaluate) {
  return [evaluate](const CornerCoordinates& u) {
    constexpr double small = 1e-7;
    CornerCoordinates scaled;
    for (int k = 0; k < 24; ++k)
      scaled[k / 3][k % 3] = small * u[k / 3][k % 3];
    ElementForce f = evaluate(scaled);
    for (auto& row : f.force)
      for (double& value : row)
        value /= small;
    return f;
  };
}

TEST(StableTimeStep, IsExactOnABoxAndSafeOnDistortedHexes) {
  for (const double poisson : {0.0, 0.2, 0.3, 0.45}) {
    const Material material{MaterialModel::linear, 1, 1, poisson};
    for (int seed = 0; seed < 6; ++seed) {
      CornerCoordinates X;
      distortedCorners(seed, 0.03 * seed, X);
      const double bound = boundOf(X, material);
      const double one_point =
          trueStep(X, 1, scaledDown([&](const CornerCoordinates& u) {
                     return onePointOf<MaterialModel::linear>(onePointGeometry(X), u, poisson);
                   }));
      const double full = trueStep(X, 1, [&](const CornerCoordinates& u) {
        return fullOf<MaterialModel::linear>(X, u, poisson);
      });
      if (seed == 0) {
        EXPECT_NEAR(bound, one_point, 1e-6 * one_point);
      }
      EXPECT_LE(bound, one_point * (1 + 1e-6)) << "seed " << seed << " nu " << poisson;
      EXPECT_GE(bound, 0.9 * one_point);
      EXPECT_LE(bound, full * (1 + 1e-6)) << "full, seed " << seed << " nu " << poisson;
    }
  }
}

TEST(StableTimeStep, OfACubeIsTheClosedFormAndDeformationChangesIt) {
  const exec_space space;
  for (const MaterialModel model : all_models) {
    const Material material{model, 1, 1, 0.3};
    BlockMesh one = makeBlocks(space, MPI_COMM_SELF, {Block()}, {material});
    const double speed = std::sqrt(material.lambda() + 2 * material.mu());
    const double expected = std::sqrt(0.7 / 1.3) / speed;
    EXPECT_NEAR(stableTimeStep(space, MPI_COMM_SELF, one.mesh).dt, expected, 1e-14);
    View<double* [3]> u("u", 8);
    EXPECT_NEAR(stableTimeStep(space, MPI_COMM_SELF, one.mesh, u).dt, expected, 1e-13);
    u = nodalField(space, one.mesh, [](const Vec3& x) { return 0.1 * x; });
    const double stretched = stableTimeStep(space, MPI_COMM_SELF, one.mesh, u).dt;
    if (model == MaterialModel::svk) {
      EXPECT_LT(stretched, 0.9 * expected); // it stiffens in tension
    }
    if (model == MaterialModel::linear) {
      EXPECT_NEAR(stretched, expected, 1e-13);
    }
    u = nodalField(space, one.mesh, [](const Vec3& x) { return Vec3{-2 * x.x, 0, 0}; });
    if (model != MaterialModel::linear) {
      EXPECT_EQ(stableTimeStep(space, MPI_COMM_SELF, one.mesh, u).dt, 0);
    }
  }
}

TEST(ContactMassFraction, IsThatOfSpringsAndDampers) {
  EXPECT_DOUBLE_EQ(contactMassFraction(0.5), 0.5 * 2.05 / 4);
  EXPECT_DOUBLE_EQ(contactMassFraction(0.5, 0.1), 2.05 * (0.125 + 0.1 * std::sqrt(0.5)));
  EXPECT_DOUBLE_EQ(contactMassFraction(0.75, 0, true), 2.55 * 0.1875);
  for (const bool edges : {false, true})
    EXPECT_DOUBLE_EQ(contactMassFraction(penaltyForMassFraction(0.9, 0.2), 0.2, edges),
                     contactMassFraction(0.9, 0, edges));
  EXPECT_NEAR(contactMassFraction(0.999 * largestPenalty(0.2, true), 0.2, true), 0.99, 1e-3);
  EXPECT_THROW(contactMassFraction(1.001 * largestPenalty(0.2, true), 0.2, true), InputError);
  EXPECT_THROW(contactMassFraction(0), InputError);
  EXPECT_THROW(contactMassFraction(-1), InputError);
  EXPECT_THROW(contactMassFraction(2), InputError);
  EXPECT_THROW(contactMassFraction(0.5, -1), InputError);
  EXPECT_THROW(contactMassFraction(0.5, 1), InputError);
}

struct CountedInverse {
  double input;
  int& evaluations;
  KOKKOS_INLINE_FUNCTION double operator()() const {
    ++evaluations;
    return 1 / input;
  }
};

TEST(RecentResults, EvaluatesEqualInputsOnceAndTellsAllBitsApart) {
  RecentResults<double, double> recent;
  int evaluations = 0;
  const auto find = [&](double input) {
    return recent.find(input, CountedInverse{input, evaluations});
  };
  for (int repetition = 0; repetition < 3; ++repetition)
    for (const double input : {0.0, -0.0, 2.0, 3.0})
      EXPECT_EQ(find(input), 1 / input);
  if (host_accessible) {
    EXPECT_EQ(evaluations, 4);
  }
  for (int repetition = 0; repetition < 2; ++repetition)
    for (int input = 1; input < 1000; ++input) // more than it remembers
      EXPECT_EQ(find(input), 1.0 / input);
}

} // namespace
} // namespace brickwall::mechanics
