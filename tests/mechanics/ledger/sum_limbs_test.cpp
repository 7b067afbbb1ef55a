// Sums of LimbSums do not depend on the kernel.
#include "mechanics/ledger/sum_limbs.hpp"

#include <gtest/gtest.h>

namespace brickwall::mechanics {
namespace {

// nvcc requires kernels outside of test bodies.
struct AddTerms {
  LimbScale scale;
  std::int64_t n;
  SumList<40> listed;
  KOKKOS_INLINE_FUNCTION static double term(std::int64_t i) {
    return static_cast<double>(i * 7919 % 20011 - 10000) /
           static_cast<double>(8000 * (1 + i % 977));
  }
  template <class Sums>
  KOKKOS_INLINE_FUNCTION void operator()(std::int64_t first, std::int64_t stride,
                                         Sums& sums) const {
    for (std::int64_t i = first; i < n; i += stride)
      sums.add(static_cast<int>(i % 40), term(i), scale);
  }
};

TEST(SumStrided, IsTheSumOfAllItems) {
  const LimbScale scale = LimbScale::forLargest(2.0);
  for (const std::int64_t n : {0, 1, 300001}) {
    AddTerms add{scale, n, {}};
    add.listed.add(0, 40);
    LimbSums<40> expected;
    add(0, 1, expected);
    expected.carry();
    for (LimbSums<40> sums : {sumStrided<40>("test::limbs", exec_space(), n, add),
                              sumStrided<40, true>("test::limbs", exec_space(), n, add)}) {
      sums.carry();
      for (int k = 0; k < LimbSums<40>::size(); ++k)
        EXPECT_EQ(sums.data()[k], expected.data()[k]) << "limb " << k << " of " << n;
    }
  }
}

} // namespace
} // namespace brickwall::mechanics
