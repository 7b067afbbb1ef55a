// Packs of every width have, lane by lane, the results of doubles.
#include "contact/base/fixed_pack.hpp"
#include "contact/base/lane_sums.hpp"
#include "contact/base/pack_memory.hpp"
#include "contact/base/pack_rounding.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

namespace brickwall {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
// A multiple of eight of them: every width meets each pair of the two lists.
constexpr double first_numbers[] = {0.0, -0.0, 1.5, -2.5, nan, infinity, -infinity, 1e-310};
constexpr double second_numbers[] = {3.0, 0.0, 1.5, nan, -1e300, 7.0, 0x1p56, -0x1p52};

void expectSame(double pack, double number) {
  EXPECT_TRUE(patternOf(pack) == patternOf(number) || (std::isnan(pack) && std::isnan(number)))
      << pack << " in place of " << number;
}

template <class Width>
class Packs : public ::testing::Test {
protected:
  static constexpr int W = Width::value;
  using Pack = PackOf<W>;
  using Integers = IntPackOf<W>;

  // Calls check(lanes of a, lanes of b) for packs of all pairs of the two lists.
  template <class Check>
  static void forAllPairs(const Check& check) {
    for (int shift = 0; shift < 8; ++shift)
      for (int first = 0; first < 8; first += W) {
        Pack a, b;
        for (int lane = 0; lane < W; ++lane) {
          setLane(a, lane, first_numbers[first + lane]);
          setLane(b, lane, second_numbers[(first + lane + shift) % 8]);
        }
        check(a, b);
      }
  }
};

using Widths = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 4>,
                                std::integral_constant<int, 8>>;
TYPED_TEST_SUITE(Packs, Widths);

TYPED_TEST(Packs, HaveTheResultsOfDoublesInEachLane) {
  this->forAllPairs([](const auto& a, const auto& b) {
    constexpr int W = TestFixture::W;
    for (int lane = 0; lane < W; ++lane) {
      const double x = a[lane], y = b[lane];
      expectSame((a + b)[lane], x + y);
      expectSame((a * b)[lane], x * y);
      expectSame((a / b)[lane], x / y);
      expectSame(where(a < b, a, b)[lane], where(x < y, x, y));
      expectSame(whereOrZero(a <= b, a)[lane], x <= y ? x : 0.0);
      expectSame(whereNotZero(a, b)[lane], whereNotZero(x, y));
      expectSame(minOf(a, b)[lane], minOf(x, y));
      expectSame(maxOf(a, b)[lane], maxOf(x, y));
      expectSame(positivePart(a)[lane], positivePart(x));
      expectSame(magnitude(a)[lane], magnitude(x));
      expectSame(squareRoot(magnitude(b))[lane], std::sqrt(std::fabs(y)));
      EXPECT_EQ(toFixed(a)[lane], toFixed(x));
      EXPECT_EQ(toFixed(b)[lane], toFixed(y));
      EXPECT_EQ(toReal(toFixed(b))[lane], toReal(toFixed(y)));
    }
    bool any = false;
    for (int lane = 0; lane < W; ++lane)
      any = any || a[lane] < b[lane];
    EXPECT_EQ(isAny(a < b), any);
  });
}

TYPED_TEST(Packs, KeepNotANumberInMinimaAndMaxima) {
  this->forAllPairs([](const auto& a, const auto& b) {
    for (int lane = 0; lane < TestFixture::W; ++lane) {
      expectSame(minOrNan(a, b)[lane], minOrNan(a[lane], b[lane]));
      expectSame(maxMagnitude(a, magnitude(b))[lane], maxMagnitude(a[lane], std::fabs(b[lane])));
    }
  });
}

TYPED_TEST(Packs, LoadAndStoreRowsOfThreeNumbers) {
  constexpr int W = TestFixture::W;
  double rows[3 * W];
  std::iota(rows, rows + 3 * W, 1.0);
  for (int count = 1; count <= W; ++count) {
    typename TestFixture::Pack xyz[3];
    loadSomeTriples<W>(rows, count, xyz);
    double stored[3 * W] = {};
    storeSomeTriples<W>(xyz, count, stored);
    for (int i = 0; i < 3 * W; ++i) {
      const double expected = i < 3 * count ? rows[i] : 0.0;
      EXPECT_EQ(xyz[i % 3][i / 3], expected) << "number " << i << " of " << count << " rows";
      EXPECT_EQ(stored[i], expected) << "number " << i << " of " << count << " rows";
    }
    loadSumOfTriples<W>(rows, rows, count, xyz);
    for (int i = 0; i < 3 * W; ++i)
      EXPECT_EQ(xyz[i % 3][i / 3], i < 3 * count ? 2 * rows[i] : 0.0);
  }
}

TYPED_TEST(Packs, LoadSomeNumbersAndFlags) {
  constexpr int W = TestFixture::W;
  using Pack = typename TestFixture::Pack;
  double numbers[W];
  unsigned char flags[W];
  for (int lane = 0; lane < W; ++lane) {
    numbers[lane] = lane + 1;
    flags[lane] = static_cast<unsigned char>(lane % 3 * 100); // 0, 100, 200
  }
  for (int count = 0; count <= W; ++count)
    for (int lane = 0; lane < W; ++lane) {
      const bool is_loaded = lane < count;
      EXPECT_EQ(loadSome<Pack>(numbers, count)[lane], is_loaded ? numbers[lane] : 0.0);
      EXPECT_EQ(loadFlags<W>(flags, count).v[lane] != 0, is_loaded && flags[lane] != 0);
      EXPECT_EQ(firstLanes<W>(count).v[lane] != 0, is_loaded);
    }
}

TYPED_TEST(Packs, ShiftInTheLastLaneOfThePackBefore) {
  constexpr int W = TestFixture::W;
  typename TestFixture::Integers before, a;
  for (int lane = 0; lane < W; ++lane) {
    before.v[lane] = lane;
    a.v[lane] = W + lane;
  }
  for (int lane = 0; lane < W; ++lane)
    EXPECT_EQ(shiftedIn(before, a)[lane], W - 1 + lane);
}

TYPED_TEST(Packs, RoundWithinTheRangeOfTheirShift) {
  constexpr int W = TestFixture::W;
  const double limit = 0x1p51;
  for (const double beyond : {nextafter(-limit, -infinity), limit, nan})
    for (int odd = 0; odd < W; ++odd) {
      Rounding<W> rounding;
      typename TestFixture::Pack a(-limit);
      setLane(a, W - 1 - odd, 2.5);
      const auto rounded = rounding.shifted(a) - rounding.shift();
      for (int lane = 0; lane < W; ++lane)
        EXPECT_EQ(rounded[lane], toFixed(a[lane]));
      EXPECT_TRUE(rounding.isGood());
      setLane(a, odd, beyond);
      rounding.shifted(a);
      EXPECT_FALSE(rounding.isGood()) << beyond << " in lane " << odd;
    }
}

} // namespace
} // namespace brickwall
