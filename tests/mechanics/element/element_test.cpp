// Point-wise mathematics of materials and elements, without a launch: gradients against differences, objectivity,
// box against general, numbering.
#include "mechanics/element/hex8_full.hpp"
#include "mechanics/element/hex8_one_point.hpp"
#include "mechanics/element/material_tangent.hpp"
#include "mechanics/element/symmetric_eigenvalue.hpp"
#include "mechanics/stability/stable_time_step.hpp"
#include "tests/mechanics/support/block_mesh.hpp"

#include <gtest/gtest.h>

namespace brickwall::mechanics {
namespace {

constexpr MaterialModel models[] = {MaterialModel::neo_hookean, MaterialModel::svk,
                                    MaterialModel::linear};

StressPoint<double> stressOf(MaterialModel model, const double (&H)[3][3], double lambda,
                             double mu) {
  StressPoint<double> point;
  if (model == MaterialModel::neo_hookean)
    neoHookean(H, lambda, mu, true, point);
  else if (model == MaterialModel::svk)
    saintVenantKirchhoff(H, lambda, mu, true, point);
  else
    linearElastic(H, lambda, mu, true, point);
  return point;
}

void randomGradient(int seed, double size, double (&H)[3][3]) {
  for (int k = 0; k < 9; ++k)
    H[k / 3][k % 3] = size * randomOf(100 * seed + k);
}

// 4 ulp (contact/base/portable_math.hpp): 4 * 2^-52 of the value.
TEST(Logarithm, AgreesWithTheLibraryAndKeepsLanesApart) {
  PackOf<8> pack;
  for (int i = -500; i < 600; ++i) {
    const double d = 0.00179 * i;
    EXPECT_NEAR(logOnePlus(d), std::log1p(d), 8.9e-16 * std::fabs(std::log1p(d)) + 1e-300) << d;
    pack.v[(i + 500) % 8] = d;
    if ((i + 500) % 8 == 7) {
      const PackOf<8> logs = logOnePlus(pack);
      for (int lane = 0; lane < 8; ++lane)
        EXPECT_EQ(logs[lane], logOnePlus(pack[lane]));
    }
  }
}

// Central differences of step e err by e^2 and eps/e: 1e-9 for e = 1e-5 at moduli of order one.
TEST(Material, StressIsTheGradientOfTheEnergyAndTheTangentThatOfTheStress) {
  for (const MaterialModel model : models)
    for (int seed = 0; seed < 5; ++seed) {
      const Material material{model, 1, 1, 0.3};
      double H[3][3], A[9][9];
      randomGradient(seed, 0.2, H);
      const auto point = stressOf(model, H, material.lambda(), material.mu());
      ASSERT_TRUE(materialTangent(H, material, A));
      for (int k = 0; k < 9; ++k) {
        constexpr double e = 1e-5;
        double plus[3][3], minus[3][3];
        std::copy(&H[0][0], &H[0][0] + 9, &plus[0][0]);
        std::copy(&H[0][0], &H[0][0] + 9, &minus[0][0]);
        plus[k / 3][k % 3] += e;
        minus[k / 3][k % 3] -= e;
        const auto p = stressOf(model, plus, material.lambda(), material.mu());
        const auto m = stressOf(model, minus, material.lambda(), material.mu());
        EXPECT_NEAR((p.W - m.W) / (2 * e), point.P[k / 3][k % 3], 1e-9);
        for (int r = 0; r < 9; ++r)
          EXPECT_NEAR((p.P[r / 3][r % 3] - m.P[r / 3][r % 3]) / (2 * e), A[r][k], 1e-8);
      }
    }
}

TEST(Material, AllModelsAgreeToFirstOrderAndKeepSmallStrainsExact) {
  double H[3][3];
  randomGradient(3, 1e-8, H);
  const auto linear = stressOf(MaterialModel::linear, H, 1.3, 0.7);
  for (const MaterialModel model : models) {
    const auto point = stressOf(model, H, 1.3, 0.7);
    for (int k = 0; k < 9; ++k) // differs by strain times stress; no cancellation against 1
      EXPECT_NEAR(point.P[k / 3][k % 3], linear.P[k / 3][k % 3], 2e-15);
    EXPECT_NEAR(point.W, linear.W, 1e-7 * linear.W + 1e-23);
  }
}

TEST(Material, CauchyStressOfUniaxialStretchIsTheClosedForm) {
  const Material material{MaterialModel::neo_hookean, 1, 1, 0.25};
  const double H[3][3] = {{0.1, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  double sigma[6];
  cauchyStress(H, material, sigma);
  const double J = 1.1, p = material.lambda() * std::log(J) / J;
  EXPECT_NEAR(sigma[0], material.mu() * (1.21 - 1) / J + p, 1e-15);
  EXPECT_NEAR(sigma[1], p, 1e-15);
  EXPECT_NEAR(sigma[3], 0, 1e-16);
}

TEST(Modes, CornersAndBackIsEightTimesTheFieldWithoutItsMean) {
  double corner[8], modes[num_modes], back[8], mean = 0;
  for (int c = 0; c < 8; ++c)
    mean += (corner[c] = std::floor(1000 * randomOf(c)));
  cornersToModes(corner, modes);
  for (int m = 0; m < 3; ++m) {
    double sum = 0;
    for (int c = 0; c < 8; ++c)
      sum += corner[c] * cornerXi(c, m);
    EXPECT_EQ(modes[m], sum);
  }
  modesToCorners(modes, back);
  for (int c = 0; c < 8; ++c)
    EXPECT_EQ(back[c], 8 * corner[c] - mean);
  const double linear[3] = {3, 5, 7}, all[num_modes] = {3, 5, 7, 0, 0, 0, 0};
  double from_linear[8], from_all[8];
  linearModesToCorners(linear, from_linear);
  modesToCorners(all, from_all);
  for (int c = 0; c < 8; ++c)
    EXPECT_EQ(from_linear[c], from_all[c]);
}

// --- elements

void distortedCorners(int seed, double size, CornerCoordinates& X) {
  const double edge[3] = {1.0, 0.7, 1.3};
  for (int c = 0; c < 8; ++c)
    for (int j = 0; j < 3; ++j)
      X[c][j] = 0.5 * edge[j] * cornerXi(c, j) + size * randomOf(1000 * seed + 3 * c + j);
}
void randomDisplacement(int seed, double size, CornerCoordinates& u) {
  for (int c = 0; c < 8; ++c)
    for (int j = 0; j < 3; ++j)
      u[c][j] = size * randomOf(7777 * seed + 3 * c + j);
}

struct ElementForce {
  double energy = 0;
  double force[8][3];
};

template <MaterialModel model, class Geometry>
ElementForce onePointOf(const Geometry& geometry, const CornerCoordinates& u, double poisson) {
  double modes[3][num_modes];
  coordinateModes(u, modes);
  OnePointForces<double> forces;
  const auto moduli = ElementModuli::of({model, 1, 1, poisson});
  onePointForces<model>(modes, geometry, stiffnessOf(geometry, moduli, 1.0), true, forces);
  ElementForce result;
  result.energy = forces.material_energy + forces.hourglass_energy;
  for (int i = 0; i < 3; ++i) {
    double corner[8];
    modesToCorners(forces.force[i], corner);
    for (int c = 0; c < 8; ++c)
      result.force[c][i] = corner[c];
  }
  return result;
}
template <MaterialModel model>
ElementForce fullOf(const CornerCoordinates& X, const CornerCoordinates& u, double poisson) {
  double modes[3][num_modes];
  coordinateModes(u, modes);
  FullGeometry<double> geometry;
  coordinateModes(X, geometry.X);
  FullForces<double> forces;
  const Material material{model, 1, 1, poisson};
  fullForces<model>(modes, geometry, material.lambda(), material.mu(), 1.0, true, forces);
  ElementForce result;
  result.energy = forces.material_energy;
  for (int i = 0; i < 3; ++i) {
    double corner[8];
    modesToCorners(forces.material[i], corner);
    for (int c = 0; c < 8; ++c)
      result.force[c][i] = corner[c];
  }
  return result;
}

template <class Evaluate>
void expectForceIsMinusEnergyGradient(const CornerCoordinates& u, const Evaluate& evaluate) {
  const ElementForce at = evaluate(u);
  for (int c = 0; c < 8; ++c)
    for (int j = 0; j < 3; ++j) {
      constexpr double e = 1e-5;
      CornerCoordinates plus, minus;
      std::copy(&u[0][0], &u[0][0] + 24, &plus[0][0]);
      std::copy(&u[0][0], &u[0][0] + 24, &minus[0][0]);
      plus[c][j] += e;
      minus[c][j] -= e;
      const double slope = (evaluate(plus).energy - evaluate(minus).energy) / (2 * e);
      EXPECT_NEAR(at.force[c][j], -slope, 2e-9); // e^2 and eps/e at stiffness of order one
    }
}

TEST(OnePoint, ForceIsMinusTheGradientOfTheEnergyOnDistortedHexes) {
  for (int seed = 0; seed < 4; ++seed) {
    CornerCoordinates X, u;
    distortedCorners(seed, 0.12, X);
    randomDisplacement(seed, 0.1, u);
    const auto geometry = onePointGeometry(X);
    expectForceIsMinusEnergyGradient(u, [&](const CornerCoordinates& d) {
      return onePointOf<MaterialModel::neo_hookean>(geometry, d, 0.3);
    });
    expectForceIsMinusEnergyGradient(u, [&](const CornerCoordinates& d) {
      return onePointOf<MaterialModel::svk>(geometry, d, 0.3);
    });
  }
}
TEST(OnePoint, ForceIsMinusTheGradientOfTheEnergyOnParallelepipeds) {
  Mat3 jacobian;
  for (int k = 0; k < 9; ++k)
    jacobian(k / 3, k % 3) = (k % 4 == 0 ? 0.5 : 0.0) + 0.1 * randomOf(k);
  CornerCoordinates u;
  randomDisplacement(1, 0.1, u);
  const OnePointBox box = onePointBox(jacobian);
  expectForceIsMinusEnergyGradient(u, [&](const CornerCoordinates& d) {
    return onePointOf<MaterialModel::neo_hookean>(box, d, 0.3);
  });
}
TEST(FullHex, ForceIsMinusTheGradientOfTheEnergy) {
  CornerCoordinates X, u;
  distortedCorners(5, 0.12, X);
  randomDisplacement(5, 0.1, u);
  expectForceIsMinusEnergyGradient(
      u, [&](const CornerCoordinates& d) { return fullOf<MaterialModel::neo_hookean>(X, d, 0.3); });
}

// Both evaluate the same formula; a few hundred operations of size one differ by rounding.
TEST(OnePoint, BoxAndGeneralPathsAgreeOnParallelepipeds) {
  Mat3 jacobian;
  for (int k = 0; k < 9; ++k)
    jacobian(k / 3, k % 3) = (k % 4 == 0 ? 0.5 : 0.0) + 0.1 * randomOf(k);
  CornerCoordinates X, u;
  for (int c = 0; c < 8; ++c)
    for (int j = 0; j < 3; ++j)
      X[c][j] = jacobian(j, 0) * cornerXi(c, 0) + jacobian(j, 1) * cornerXi(c, 1) +
                jacobian(j, 2) * cornerXi(c, 2);
  randomDisplacement(2, 0.1, u);
  const auto general = onePointOf<MaterialModel::neo_hookean>(onePointGeometry(X), u, 0.3);
  const auto box = onePointOf<MaterialModel::neo_hookean>(onePointBox(jacobian), u, 0.3);
  EXPECT_NEAR(general.energy, box.energy, 1e-14);
  for (int c = 0; c < 8; ++c)
    for (int j = 0; j < 3; ++j)
      EXPECT_NEAR(general.force[c][j], box.force[c][j], 1e-14);
}
TEST(OnePoint, BrickAndBoxPathsAgree) {
  Mat3 jacobian;
  for (int k = 0; k < 3; ++k)
    jacobian(k, k) = 0.5 + 0.2 * k;
  ASSERT_TRUE(isOnePointBrick(jacobian));
  CornerCoordinates u;
  randomDisplacement(2, 0.1, u);
  const auto box = onePointOf<MaterialModel::neo_hookean>(onePointBox(jacobian), u, 0.3);
  const auto brick = onePointOf<MaterialModel::neo_hookean>(onePointBrick(jacobian), u, 0.3);
  EXPECT_NEAR(brick.energy, box.energy, 1e-14);
  for (int c = 0; c < 8; ++c)
    for (int j = 0; j < 3; ++j)
      EXPECT_NEAR(brick.force[c][j], box.force[c][j], 1e-14);
}

Mat3 rotation(double angle) { // about (1, 2, 3)
  const double s = 1 / std::sqrt(14.0), n[3] = {s, 2 * s, 3 * s};
  const double cosine = std::cos(angle), sine = std::sin(angle);
  Mat3 r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      r(i, j) = (i == j ? cosine : 0.0) + (1 - cosine) * n[i] * n[j];
  r(0, 1) -= sine * n[2], r(1, 0) += sine * n[2];
  r(0, 2) += sine * n[1], r(2, 0) -= sine * n[1];
  r(1, 2) -= sine * n[0], r(2, 1) += sine * n[0];
  return r;
}

TEST(OnePoint, ForcesTurnWithTheElement) {
  CornerCoordinates X, u, turned;
  distortedCorners(8, 0.12, X);
  randomDisplacement(8, 0.1, u);
  const Mat3 r = rotation(2.1);
  for (int c = 0; c < 8; ++c) {
    const Vec3 x = r * Vec3{X[c][0] + u[c][0], X[c][1] + u[c][1], X[c][2] + u[c][2]};
    for (int j = 0; j < 3; ++j)
      turned[c][j] = x[j] - X[c][j];
  }
  const auto geometry = onePointGeometry(X);
  const auto before = onePointOf<MaterialModel::neo_hookean>(geometry, u, 0.3);
  const auto after = onePointOf<MaterialModel::neo_hookean>(geometry, turned, 0.3);
  EXPECT_NEAR(after.energy, before.energy, 1e-14);
  for (int c = 0; c < 8; ++c) {
    const Vec3 f = r * Vec3{before.force[c][0], before.force[c][1], before.force[c][2]};
    for (int j = 0; j < 3; ++j)
      EXPECT_NEAR(after.force[c][j], f[j], 1e-14);
  }
}

// Renumbering: corners turned about zeta by a quarter (new corner c is old corner turn[c]).
TEST(OnePoint, ForcesDoNotDependOnTheNumberingOfTheCorners) {
  const int turn[8] = {1, 2, 3, 0, 5, 6, 7, 4}, roll[8] = {0, 4, 5, 1, 3, 7, 6, 2};
  for (const auto& order : {turn, roll}) {
    CornerCoordinates X, u, X2, u2;
    distortedCorners(9, 0.12, X);
    randomDisplacement(9, 0.1, u);
    for (int c = 0; c < 8; ++c)
      for (int j = 0; j < 3; ++j) {
        X2[c][j] = X[order[c]][j];
        u2[c][j] = u[order[c]][j];
      }
    ASSERT_GT(hexVolume(X2).min_determinant, 0);
    const auto first = onePointOf<MaterialModel::svk>(onePointGeometry(X), u, 0.3);
    const auto second = onePointOf<MaterialModel::svk>(onePointGeometry(X2), u2, 0.3);
    for (int c = 0; c < 8; ++c)
      for (int j = 0; j < 3; ++j)
        EXPECT_NEAR(second.force[c][j], first.force[order[c]][j], 1e-14);
  }
}

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
  testing::BlockMesh one =
      testing::makeBlocks(space, MPI_COMM_SELF, {testing::Block()}, {material});
  const auto host = Kokkos::create_mirror_view(one.mesh.reference_coordinates);
  const int corner_of_grid[8] = {0, 1, 3, 2, 4, 5, 7, 6};
  for (int g = 0; g < 8; ++g)
    for (int j = 0; j < 3; ++j)
      host(g, j) = X[corner_of_grid[g]][j];
  Kokkos::deep_copy(one.mesh.reference_coordinates, host);
  return stableTimeStep(space, MPI_COMM_SELF, one.mesh).dt;
}

// The linear material's force is not linear in u for the hourglass part (q = Q F^T g), so displacements are scaled down.
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
  for (const MaterialModel model : models) {
    const Material material{model, 1, 1, 0.3};
    testing::BlockMesh one =
        testing::makeBlocks(space, MPI_COMM_SELF, {testing::Block()}, {material});
    const double speed = std::sqrt(material.lambda() + 2 * material.mu());
    const double expected = std::sqrt(0.7 / 1.3) / speed;
    EXPECT_NEAR(stableTimeStep(space, MPI_COMM_SELF, one.mesh).dt, expected, 1e-14);
    View<double* [3]> u("u", 8);
    EXPECT_NEAR(stableTimeStep(space, MPI_COMM_SELF, one.mesh, u).dt, expected, 1e-13);
    u = testing::nodalField(space, one.mesh, [](const Vec3& x) { return 0.1 * x; });
    const double stretched = stableTimeStep(space, MPI_COMM_SELF, one.mesh, u).dt;
    if (model == MaterialModel::svk) {
      EXPECT_LT(stretched, 0.9 * expected); // it stiffens in tension
    }
    if (model == MaterialModel::linear) {
      EXPECT_NEAR(stretched, expected, 1e-13);
    }
    u = testing::nodalField(space, one.mesh, [](const Vec3& x) { return Vec3{-2 * x.x, 0, 0}; });
    if (model != MaterialModel::linear) {
      EXPECT_EQ(stableTimeStep(space, MPI_COMM_SELF, one.mesh, u).dt, 0);
    }
  }
}

TEST(ContactLoad, IsTheShareOfTheMassThatSpringsAndDampersTake) {
  EXPECT_DOUBLE_EQ(contactMassFraction(0.5), 0.5 * 2.05 / 4);
  EXPECT_DOUBLE_EQ(contactMassFraction(0.5, 0.1), 2.05 * (0.125 + 0.1 * std::sqrt(0.5)));
  EXPECT_DOUBLE_EQ(contactMassFraction(0.75, 0, true), 2.55 * 0.1875);
  for (const bool edges : {false, true})
    EXPECT_DOUBLE_EQ(contactMassFraction(penaltyForMassFraction(0.9, 0.2), 0.2, edges),
                     contactMassFraction(0.9, 0, edges));
  EXPECT_THROW(contactMassFraction(-1), InputError);
  EXPECT_THROW(contactMassFraction(2), InputError);
  EXPECT_THROW(contactMassFraction(0.5, -1), InputError);
  EXPECT_THROW(contactMassFraction(0.5, 1), InputError);
}

} // namespace
} // namespace brickwall::mechanics
