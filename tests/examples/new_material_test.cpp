// Worked example of CONTRIBUTING.md, "Adding a material": the point-wise function of a hyperelastic
// material, with the test that every material must pass.
#include "contact/base/hash.hpp"
#include "mechanics/element/material.hpp"
#include "tests/mechanics/support/element_force.hpp"

#include <gtest/gtest.h>

namespace brickwall::mechanics {
namespace {

// W = mu/2 (tr C - 3 - 2 ln J) + lambda/4 (J^2 - 1 - 2 ln J), so that F^-T has the factor
// lambda (J^2 - 1)/2 instead of lambda ln J; else as neoHookean() in material.hpp, which explains
// the form without cancellation at small strain. Real is double, or a pack of elements.
template <class Real>
KOKKOS_INLINE_FUNCTION void quadraticVolume(const Real (&H)[3][3], double lambda, double mu,
                                            StressPoint<Real>& out) {
  Real C[3][3], square = 0.0;
  cofactors(H, C);
  const Real t = H[0][0] + H[1][1] + H[2][2], d = volumeChange(H), e = d - t;
  out.J = 1.0 + d;
  const Real volume = 0.5 * (d * (2.0 + d)); // (J^2 - 1)/2
  const Real p = mu / out.J, r = lambda * volume / out.J;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      out.P[i][j] = mu * H[i][j] + (p - r) * (H[j][i] - C[i][j]);
      square = square + H[i][j] * H[i][j];
    }
  for (int i = 0; i < 3; ++i)
    out.P[i][i] = out.P[i][i] + p * e + r * (1.0 + t);
  const Real log_J = logOnePlus(d);
  out.W = mu * (0.5 * square + t - log_J) + 0.5 * lambda * (volume - log_J);
}

StressPoint<double> stressAt(const double (&H)[3][3]) {
  StressPoint<double> point;
  quadraticVolume(H, 0.7, 0.4, point);
  return point;
}

// Central differences of step e have errors of e^2 and eps/e: 1e-9 for e = 1e-5 at moduli of order
// one.
TEST(ExampleMaterial, StressIsTheGradientOfTheEnergy) {
  for (int seed = 0; seed < 5; ++seed) {
    double H[3][3];
    for (int k = 0; k < 9; ++k)
      H[k / 3][k % 3] = 0.2 * randomOf(100 * seed + k);
    const StressPoint<double> point = stressAt(H);
    for (int k = 0; k < 9; ++k) {
      constexpr double e = 1e-5;
      double& entry = H[k / 3][k % 3];
      const double value = entry;
      entry = value + e;
      const double plus = stressAt(H).W;
      entry = value - e;
      const double minus = stressAt(H).W;
      entry = value;
      EXPECT_NEAR((plus - minus) / (2 * e), point.P[k / 3][k % 3], 1e-9);
    }
  }
}

// The same moduli at rest as all materials: the difference from linear elasticity is of the order
// of H^2.
TEST(ExampleMaterial, IsLinearAtSmallStrain) {
  double H[3][3];
  for (int k = 0; k < 9; ++k)
    H[k / 3][k % 3] = 1e-8 * randomOf(k);
  StressPoint<double> linear;
  linearElastic(H, 0.7, 0.4, false, linear);
  for (int k = 0; k < 9; ++k)
    EXPECT_NEAR(stressAt(H).P[k / 3][k % 3], linear.P[k / 3][k % 3], 2e-15);
}

// Packs give the bits of single elements.
TEST(ExampleMaterial, HasTheSameBitsInPacks) {
  double H[3][3];
  Lanes packs[3][3];
  for (int k = 0; k < 9; ++k) {
    H[k / 3][k % 3] = 0.1 * randomOf(k);
    packs[k / 3][k % 3] = Lanes(H[k / 3][k % 3]);
  }
  StressPoint<Lanes> point;
  quadraticVolume(packs, 0.7, 0.4, point);
  EXPECT_EQ(laneOf(point.P[0][1], simd_width - 1), stressAt(H).P[0][1]);
  EXPECT_EQ(laneOf(point.W, 0), stressAt(H).W);
}

} // namespace
} // namespace brickwall::mechanics
