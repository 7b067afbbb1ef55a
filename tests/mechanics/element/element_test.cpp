// Point-wise mathematics of materials and elements, without a launch: gradients against
// differences, objectivity, the box against the general element, numbering of corners.
#include "mechanics/element/hex8_full.hpp"
#include "mechanics/element/hex8_one_point.hpp"
#include "mechanics/element/material_tangent.hpp"
#include "tests/mechanics/support/element_force.hpp"

#include <gtest/gtest.h>

namespace brickwall::mechanics {
namespace {

using namespace testing;

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

// 4 ulp (contact/base/portable_math.hpp), which is 4 * 2^-52 of the value.
TEST(Logarithm, AgreesWithTheLibraryAndKeepsLanesApart) {
  Lanes lanes(0.0);
  for (int i = -500; i < 600; ++i) {
    const double d = 0.00179 * i;
    EXPECT_NEAR(logOnePlus(d), std::log1p(d), 8.9e-16 * std::fabs(std::log1p(d)) + 1e-300) << d;
    setLane(lanes, (i + 500) % simd_width, d);
    if ((i + 501) % simd_width == 0) {
      const Lanes logs = logOnePlus(lanes);
      for (int lane = 0; lane < simd_width; ++lane)
        EXPECT_EQ(laneOf(logs, lane), logOnePlus(laneOf(lanes, lane)));
    }
  }
}

// Central differences of step e have errors of e^2 and eps/e: 1e-9 for e = 1e-5 at moduli of order
// one.
TEST(Material, StressIsTheGradientOfTheEnergyAndTangentThatOfStress) {
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
    for (int k = 0; k < 9; ++k) // differs by strain times stress, without cancellation against 1
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

TEST(Modes, TransformAndTransposeGiveEightTimesTheFieldWithoutItsMean) {
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

TEST(OnePoint, ForcesRotateWithTheElement) {
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

// The corners are rotated about zeta by a quarter turn (new corner c is old corner turn[c]).
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

} // namespace
} // namespace brickwall::mechanics
