// Sums and rounding of single terms by additions of large numbers, against the plain functions.
#include "contact/base/lane_sums.hpp"
#include "contact/base/pack_rounding.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace brickwall {
namespace {

TEST(SplitSumsTest, AreLimbSums) {
  const LimbScale scale = LimbScale::forLargest(2.0);
  const SplitScale split_scale = SplitScale::of(scale);
  const auto scales = [&](int) -> const SplitScale& { return split_scale; };
  const auto reversed = [](int k) { return 1 - k; };
  LimbSums<2> expected, sums;
  SplitSums<2> split;
  for (int i = 0; i < static_cast<int>(split.max_rows); ++i) {
    for (int k = 0; k < 2; ++k) {
      const double term = std::sin(2 * i + k) / (1 + i % 977);
      expected.add(1 - k, term, scale);
      split.add(k, term, split_scale);
    }
    split.endRow();
  }
  split.foldInto(sums, reversed, scales);
  expected.carry();
  sums.carry();
  for (int k = 0; k < LimbSums<2>::size(); ++k)
    EXPECT_EQ(sums.data()[k], expected.data()[k]) << "limb " << k;
  for (const double unfit : {4.0, std::nan("")}) {
    split.add(0, unfit, split_scale);
    split.foldInto(sums, reversed, scales);
  }
  EXPECT_EQ(sums.invalid, 2);
}

TEST(RoundAllTest, IsRoundingOneByOne) {
  const double limit = 2251799813685248.0; // 2^51
  const auto check = [](const double(&quanta)[3], double largest) {
    std::int64_t rounded[3];
    double found = 0;
    roundAll(quanta, found, rounded);
    for (int i = 0; i < 3; ++i)
      EXPECT_EQ(rounded[i], toFixed(quanta[i])) << quanta[i];
    EXPECT_TRUE(found == largest || (found != found && largest != largest)) << found;
  };
  check({0.5, -1.5, 2.5}, 0);
  check({-limit, limit - 1.5, 1e-300}, 0);
  check({limit, -3.5, 7}, limit);
  check({-2 * limit, 2 * limit + 1, -0.0}, 2 * limit + 1);
  check({fixed_point_limit, -0.5, HUGE_VAL}, HUGE_VAL);
  check({1, std::nan(""), -limit - 1}, std::nan(""));
}

} // namespace
} // namespace brickwall
