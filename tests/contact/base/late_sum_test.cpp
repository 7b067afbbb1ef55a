// Sums that the host reads later (contact/base/sum_over.hpp), by the kernels of devices and of
// hosts.
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

// Adds `factor` to each item and sums them.
struct Raise {
  View<std::int64_t*> items;
  std::int64_t factor;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t i, CountAndLargest& sums) const {
    items(i) += factor;
    sums.sum += items(i);
    ++sums.count;
  }
};

TEST(LaunchedSumsTest, MarkedSumsAreThoseOfTheKernelsBeforeTheMark) {
  const exec_space space;
  constexpr std::int64_t num_items = 1 << 20;
  const View<std::int64_t*> items("test::items", num_items);
  LaunchedSums<CountAndLargest> marked, later;
  for (int round = 0; round < 20; ++round) { // each reads what the round before has left
    const std::int64_t before = 1001 * round;
    launchSum<CountAndLargest>("test::marked", space, 0, num_items, Raise{items, 1},
                               marked.next(space));
    marked.mark(space);
    launchSum<CountAndLargest>("test::later", space, 0, num_items, Raise{items, 1000},
                               later.next(space));
    const CountAndLargest sums = marked.read(space);
    EXPECT_EQ(sums.count, num_items);
    EXPECT_EQ(sums.sum, (before + 1) * num_items);
    EXPECT_EQ(later.read(space).sum, (before + 1001) * num_items); // without a mark: waits for all
    // A kernel after the mark belongs to the next sum that is read.
    launchSum<CountAndLargest>("test::first", space, 0, 1, Raise{items, 0}, marked.next(space));
    marked.mark(space);
    launchSum<CountAndLargest>("test::second", space, 1, num_items, Raise{items, 0},
                               marked.next(space));
    EXPECT_EQ(marked.read(space).count, num_items);
  }
}

} // namespace
} // namespace brickwall
