// The portable functions against long double. Their errors come from a few roundings after the last
// addition: 4 ulp, 4 * 2^-53 relative to values in [1, 2), is a generous bound.
#include "contact/base/portable_math.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace {

using namespace brickwall;

constexpr double four_ulp = 4 * 2.220446049250313e-16;

double relativeError(double computed, long double exact) {
  return static_cast<double>(std::fabs((computed - exact) / exact));
}

TEST(PortableMath, AgreesWithLongDoubleToFourUlp) {
  std::mt19937_64 random(1);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  double worst_log = 0, worst_exp = 0, worst_sin = 0, worst_sinc = 0;
  for (int i = 0; i < 100000; ++i) {
    const double d = i % 2 == 0 ? uniform(-0.9999, 3) : std::exp2(-uniform(0, 60));
    worst_log = std::fmax(worst_log, relativeError(portableLog1p(d), std::log1p((long double)d)));
    const double x = uniform(-700, 700);
    worst_exp = std::fmax(worst_exp, relativeError(portableExp(x), std::exp((long double)x)));
    const double s = uniform(0, 0.5); // beyond, the function is that of 1 - s
    constexpr long double pi = 3.14159265358979323846264338327950288L;
    worst_sin = std::fmax(worst_sin, relativeError(portableSinPi(s), std::sin(pi * s)));
    ASSERT_EQ(portableSinPi(1 - s), portableSinPi(1 - (1 - s)));
    const double share = uniform(1.0 / 16, 1);
    worst_sinc =
        std::fmax(worst_sinc, relativeError(portableOneMinusSincPi(share),
                                            1 - std::sin(pi * share) / (pi * (long double)share)));
  }
  EXPECT_LE(worst_log, four_ulp);
  EXPECT_LE(worst_exp, four_ulp);
  EXPECT_LE(worst_sin, four_ulp);
  EXPECT_LE(worst_sinc, four_ulp); // the reference errs by 2^-64/s^2, at s = 1/16 a 16th of an ulp
}

// All results depend on this bit for bit (contact/base/CMakeLists.txt). (1 + 2^-30)^2 = 1 + 2^-29 +
// 2^-60: with a fused addition the last term would remain.
TEST(PortableMath, NoMultiplicationIsFusedWithAnAddition) {
  const volatile double a = 1 + 0x1p-30, c = -(1 + 0x1p-29);
  EXPECT_EQ(a * a + c, 0.0);
}

TEST(PortableMath, KeepsTheEndsOfItsRanges) {
  EXPECT_EQ(portableLog1p(0), 0);
  EXPECT_EQ(portableLog1p(-1), -HUGE_VAL);
  EXPECT_TRUE(std::isnan(portableLog1p(-1.5)));
  EXPECT_TRUE(std::isnan(portableLog1p(NAN)));
  EXPECT_EQ(portableLog1p(HUGE_VAL), HUGE_VAL);
  EXPECT_EQ(portableExp(0), 1);
  EXPECT_EQ(portableExp(-HUGE_VAL), 0);
  EXPECT_EQ(portableExp(800), HUGE_VAL);
  EXPECT_TRUE(std::isnan(portableExp(NAN)));
  EXPECT_EQ(portableSinPi(0), 0);
  EXPECT_EQ(portableSinPi(1), 0);
  EXPECT_NEAR(portableSinPi(0.5), 1, four_ulp);
  EXPECT_EQ(portableOneMinusSincPi(0), 0);
  EXPECT_EQ(portableOneMinusSincPi(1), 1);
  EXPECT_NEAR(portableOneMinusSincPi(1e-9) / 1.6449340668482264e-18, 1, four_ulp); // (pi s)^2/6
}

} // namespace
