// Sums that several kernels add to (contact/base/sum_over.hpp), by the kernels of devices and of hosts.
#include "contact/base/sum_over.hpp"

#include <gtest/gtest.h>

namespace brickwall {
namespace {

struct CountAndLargest {
  static constexpr int num_maxima = 1;
  std::int64_t count = 0, sum = 0;
  double largest = 0;
  KOKKOS_INLINE_FUNCTION CountAndLargest& operator+=(const CountAndLargest& b) {
    count += b.count;
    sum += b.sum;
    largest = maxOf(largest, b.largest);
    return *this;
  }
};
struct AddItem {
  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t i, CountAndLargest& sums) const {
    ++sums.count;
    sums.sum -= i;
    sums.largest = maxOf(sums.largest, 0.25 * static_cast<double>(i % 1000));
  }
};

template <bool on_device>
void expectSumsOfBothKernels() {
  const exec_space space;
  LateSum<CountAndLargest, on_device> late("test::late");
  for (int round = 0; round < 2; ++round) { // the second starts from zero
    Kokkos::deep_copy(space, late.clear(), std::int64_t(0));
    late.send(space);
    EXPECT_EQ(late.read(space).count, 0);
    late.template add<4>("test::first", space, 5, 5, AddItem());
    late.add("test::second", space, 0, 4001, AddItem());
    late.add("test::third", space, 10, 12, AddItem());
    late.send(space);
    const CountAndLargest sums = late.read(space);
    EXPECT_EQ(sums.count, 4003);
    EXPECT_EQ(sums.sum, -4000 * 4001 / 2 - 21);
    EXPECT_EQ(sums.largest, 0.25 * 999);
  }
}

TEST(LateSumTest, KernelsAddToOneSumOnBothPaths) {
  expectSumsOfBothKernels<true>();
  expectSumsOfBothKernels<!host_accessible>();
}

} // namespace
} // namespace brickwall
