// The parts that all libraries share: order-free sums, boxes, scans, exchange plans, errors thrown
// on all ranks.
#include "contact/base/box.hpp"
#include "contact/base/error.hpp"
#include "contact/base/fixed_point.hpp"
#include "contact/base/group_by_key.hpp"
#include "contact/base/messages/exchange_plan.hpp"
#include "contact/base/mpi.hpp"
#include "contact/base/scan.hpp"
#include "contact/base/sum_over.hpp"
#include "contact/base/to_device.hpp"
#include "tests/support/communicator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace brickwall {
namespace {

TEST(FixedPointTest, QuantumIsTheStatedPowerOfTwo) {
  EXPECT_EQ(Quantum::forForceScale(1.0).value, 0x1p-54);
  EXPECT_EQ(Quantum::forForceScale(1.5).value, 0x1p-53);
  EXPECT_EQ(Quantum::forForceScale(1e6).value, 0x1p-34); // 2^20 >= 1e6
  EXPECT_EQ(Quantum::forForceScale(std::nextafter(0x1p20, 2e6)).value, 0x1p-33); // log2 says 20
  EXPECT_EQ(Quantum::powerOfTwo(-7).value * Quantum::powerOfTwo(-7).inverse, 1.0);
}

TEST(FixedPointTest, RoundsToNearestWithTiesToEven) {
  EXPECT_EQ(roundToFixed(2.5), 2);
  EXPECT_EQ(roundToFixed(3.5), 4);
  EXPECT_EQ(roundToFixed(-2.5), -2);
  EXPECT_EQ(roundToFixed(-1e15 - 0.25), -1000000000000000);
}

TEST(FixedPointTest, RefusesWhatDoesNotFit) {
  EXPECT_TRUE(fitsFixedPoint(std::nextafter(fixed_point_limit, 0.0)));
  for (const double value :
       {fixed_point_limit, -fixed_point_limit, HUGE_VAL, -HUGE_VAL, std::nan("")}) {
    EXPECT_FALSE(fitsFixedPoint(value));
    EXPECT_EQ(roundToFixed(value), 0); // defined, and counted by the caller
  }
}

// Terms k 2^-80 of random sign and size, |k| < 2^63: their sum is exact in 128 bits.
std::vector<double> randomTerms(int n, __int128& exact) {
  std::mt19937_64 random(1);
  std::vector<double> terms;
  exact = 0;
  for (int i = 0; i < n; ++i) {
    const int shift = static_cast<int>(random() % 60);
    const double k = static_cast<double>(static_cast<std::int64_t>(random()) >> shift);
    terms.push_back(std::ldexp(k, -80));
    exact += static_cast<__int128>(k);
  }
  return terms;
}

TEST(LimbSumTest, IsTheExactSumWhateverTheOrder) {
  __int128 exact = 0;
  std::vector<double> terms = randomTerms(100000, exact);
  const LimbScale scale = LimbScale::forLargest(0x1p-16); // above all terms
  const double expected = static_cast<double>(exact) * 0x1p-80;
  std::mt19937_64 random(2);
  LimbSum first;
  for (const double term : terms)
    ASSERT_TRUE(first.add(term, scale));
  // The value differs from the exact sum only by the roundings of the conversion of three limbs: 2
  // ulp.
  EXPECT_NEAR(first.value(scale), expected, 2 * std::fabs(expected) * 0x1p-52);
  for (int order = 0; order < 5; ++order) {
    std::shuffle(terms.begin(), terms.end(), random);
    LimbSum sum;
    for (const double term : terms)
      sum.add(term, scale);
    EXPECT_EQ(sum.value(scale), first.value(scale)); // the same bits
  }
}

TEST(LimbSumTest, LargeTermsThatCancelLeaveTheSmallOnes) {
  const LimbScale scale = LimbScale::forLargest(1e9);
  LimbSum sum;
  for (const double term : {1e9 - 1, 1e-6, -(1e9 - 1), 0.5, -1e8 / 3, 1e8 / 3})
    ASSERT_TRUE(sum.add(term, scale));
  EXPECT_EQ(sum.value(scale), 0.5 + 1e-6);
}

TEST(LimbSumTest, CountsTermsBeyondTheScaleAndNotANumber) {
  const LimbScale scale = LimbScale::forLargest(1.0);
  LimbSums<2> sums;
  sums.add(0, 0.5, scale);
  sums.add(0, 1e3, scale);
  sums.add(1, std::nan(""), scale);
  sums.add(1, -HUGE_VAL, scale);
  EXPECT_EQ(sums.invalid, 3);
  EXPECT_EQ(sums.sum[0].value(scale), 0.5);
  EXPECT_EQ(sums.sum[1].value(scale), 0.0);
}

// Quotients of integers: the same bits on host and device.
KOKKOS_INLINE_FUNCTION double term(std::int64_t i) {
  return static_cast<double>(i * 7919 % 20011 - 10000) / static_cast<double>(8000 * (1 + i % 977));
}

// Term i is on rank i % size, in sum i % 40. nvcc requires kernels outside of test bodies.
using FortySums = LimbSums<40>;
struct AddOwnTerm {
  int rank, size;
  LimbScale scale;
  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t i, FortySums& sums) const {
    if (i % size == rank)
      sums.add(static_cast<int>(i % 40), term(i), scale);
  }
};

TEST(LimbSumTest, RanksAndThreadsDoNotShowInTheBits) {
  const LimbScale scale = LimbScale::forLargest(2.0);
  using Range = std::pair<int, int>;
  for (const auto& [begin, end] : {Range{0, 0}, Range{7, 8}, Range{300001, 600002}}) {
    FortySums mine = sumOver<FortySums>("test::limbs", exec_space(), begin, end,
                                        AddOwnTerm{rankOf(comm), sizeOf(comm), scale});
    allReduce(comm, mine);
    FortySums serial;
    for (int i = end - 1; i >= begin; --i)
      serial.add(i % 40, term(i), scale);
    for (int k = 0; k < 40; ++k)
      EXPECT_EQ(mine.sum[k].value(scale), serial.sum[k].value(scale)) << k << ' ' << end;
    EXPECT_EQ(mine.invalid, 0);
  }
}

Box boxOf(const Vec3& a, const Vec3& b) {
  Box box;
  box.include(a);
  box.include(b);
  return box;
}

TEST(BoxTest, EmptyBoxOverlapsNothingAndIsNeutralInUnions) {
  Box box;
  EXPECT_TRUE(box.empty());
  const Box everything = boxOf({-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, HUGE_VAL, HUGE_VAL});
  const Box unit = boxOf({0, 0, 0}, {1, 1, 1});
  EXPECT_FALSE(box.overlaps(box));
  EXPECT_FALSE(box.overlaps(unit));
  EXPECT_FALSE(unit.overlaps(box));
  EXPECT_TRUE(everything.overlaps(unit));
  box += unit;
  EXPECT_EQ(box.lower[0], 0);
  EXPECT_EQ(box.upper[2], 1);
}

TEST(BoxTest, OverlapIsClosed) {
  const Box a = boxOf({0, 0, 0}, {1, 1, 1}), b = boxOf({1, 1, 1}, {1, 1, 1});
  EXPECT_TRUE(a.overlaps(b)); // a corner touches a point
  const Vec3 beside = {std::nextafter(1.0, 2.0), 0.5, 0.5};
  Box c = boxOf(beside, beside);
  EXPECT_FALSE(a.overlaps(c));
  c.inflate(0x1p-52);
  EXPECT_TRUE(c.overlaps(a));
}

TEST(ScanTest, OffsetsAreSumsOfTheCountsBefore) {
  const exec_space space;
  for (const int n : {0, 1, 1000}) {
    std::vector<std::int64_t> counts(n + 1, 7), expected(n + 1, 0); // the last count is not read
    for (int i = 0; i < n; ++i) {
      counts[i] = i % 4;
      expected[i + 1] = expected[i] + counts[i];
    }
    const auto in_place = toDevice(space, "counts", counts);
    const View<std::int64_t*> offsets("offsets", n + 1);
    launchScan(space, "test::launchScan", in_place, n, offsets);
    EXPECT_EQ(scanCounts(space, "test::scanCounts", in_place, n), expected[n]);
    space.fence();
    const auto found = toHost(offsets), found_in_place = toHost(in_place);
    for (int i = 0; i <= n; ++i) {
      EXPECT_EQ(found(i), expected[i]) << i << " of " << n;
      EXPECT_EQ(found_in_place(i), expected[i]) << i << " of " << n;
    }
  }
}

TEST(ScanTest, FlaggedRowsAreListedInTheirOrder) {
  const exec_space space;
  for (const int n : {0, 1, 1000}) {
    std::vector<unsigned char> flags(n + 1);
    std::vector<int> rows, expected, before(1, 0);
    for (int i = 0; i < n; ++i) {
      rows.push_back(n - i); // none is row 0
      flags[n - i] = i % 3 == 0;
      if (i % 3 == 0)
        expected.push_back(n - i);
      before.push_back(static_cast<int>(expected.size()));
    }
    const View<int*> listed("listed", n), found_before("before", n + 1);
    listFlagged(space, "test::listFlagged",
                View<const unsigned char*>(toDevice(space, "flags", flags)),
                toDevice(space, "rows", rows), n, listed, found_before);
    space.fence();
    const auto found = toHost(listed);
    const auto counts = toHost(found_before);
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_EQ(found(i), expected[i]) << i << " of " << n;
    for (std::size_t i = 0; i < before.size(); ++i)
      EXPECT_EQ(counts(i), before[i]) << i << " of " << n;
  }
}

TEST(GrowTest, GrownViewsKeepLabelWidthAndCapacity) {
  const exec_space space;
  View<double* [3]> view("grown", 2);
  growTo(space, view, 100);
  EXPECT_EQ(view.label(), "grown");
  EXPECT_GE(view.extent(0), 100u);
  EXPECT_EQ(view.extent(1), 3u);
  const auto* const data = view.data();
  growTo(space, view, 50);
  EXPECT_EQ(view.data(), data); // no View shrinks or is reallocated
}

TEST(TogetherTest, AllRanksThrowWhatTheLowestFailingRankThrew) {
  const int rank = rankOf(comm), size = sizeOf(comm);
  for (int failing = 0; failing < size; ++failing) {
    std::string message;
    ExitCode code = ExitCode::success;
    try {
      rethrowOnAllRanks(comm, [&] {
        if (rank >= failing && failing % 2 == 0)
          throw InputError("rank " + std::to_string(rank) + " read a bad file");
        if (rank >= failing)
          throw std::runtime_error("rank " + std::to_string(rank) + " ran out of luck");
      });
    } catch (const Error& error) {
      message = error.what();
      code = error.code();
    }
    const std::string who = "rank " + std::to_string(failing);
    EXPECT_EQ(message, who + (failing % 2 == 0 ? " read a bad file" : " ran out of luck"));
    EXPECT_EQ(code, failing % 2 == 0 ? ExitCode::bad_input : ExitCode::internal);
  }
  EXPECT_NO_THROW(rethrowOnAllRanks(comm, [] {}));
}

TEST(TogetherTest, ARankWithoutMemoryIsNamedOnAll) {
  const int last = sizeOf(comm) - 1;
  try {
    rethrowOnAllRanks(comm, [&] {
      if (rankOf(comm) == last)
        throw std::bad_alloc();
    });
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), "out of memory on rank " + std::to_string(last));
  }
}

TEST(MpiTest, ReductionsAndBroadcastsReachAllRanks) {
  const int rank = rankOf(comm), size = sizeOf(comm);
  EXPECT_EQ(allReduce(comm, rank, MPI_MAX), size - 1);
  EXPECT_EQ(allReduce(comm, 0.5, MPI_SUM), 0.5 * size);
  EXPECT_EQ(broadcast(comm, rank == size - 1 ? "last" : "", size - 1), "last");
  EXPECT_THROW(checkedInt(std::int64_t(1) << 31, "rows"), Error);
  EXPECT_EQ(checkedInt((std::int64_t(1) << 31) - 1, "rows"), std::numeric_limits<int>::max());
}

// The other ranks may not unwind, and freeing would wait for them.
TEST(MpiTest, ARankThatUnwindsKeepsItsCommunicators) {
  MPI_Comm kept = MPI_COMM_NULL;
  try {
    const Communicator own(comm);
    kept = own;
    throw InputError("of this rank alone");
  } catch (const InputError&) {
  }
  EXPECT_EQ(sizeOf(kept), sizeOf(comm));
  checkMpi(MPI_Comm_free(&kept), "MPI_Comm_free");
}

TEST(MpiTest, ExchangeByRankDeliversListsOfAnyLength) {
  const int rank = rankOf(comm), size = sizeOf(comm);
  std::vector<std::vector<int>> lists(size);
  for (int q = 0; q < size; ++q)
    lists[q].assign(static_cast<std::size_t>((rank + 2 * q) % 3), 100 * rank + q);
  const auto received = exchangeByRank(comm, lists);
  for (int q = 0; q < size; ++q)
    EXPECT_EQ(received[q],
              std::vector<int>(static_cast<std::size_t>((q + 2 * rank) % 3), 100 * q + rank));
}

// Key k is listed twice by each of the ranks 0 .. k.
TEST(MpiTest, CountOnAllRanksCountsWhatEachRankLists) {
  const int size = sizeOf(comm), rank = rankOf(comm);
  std::vector<std::int64_t> keys, expected;
  for (int repetition = 0; repetition < 2; ++repetition)
    for (std::int64_t key = 100; key-- > rank;) {
      keys.push_back(key);
      expected.push_back(2 * std::min<std::int64_t>(key + 1, size));
    }
  EXPECT_EQ(countOnAllRanks(comm, keys, [](std::int64_t key) { return key; }), expected);
}

TEST(HostArrayTest, HasDefaultValuesOfAnyNumber) {
  struct Pair {
    int first = 7, second = -1;
  };
  for (const std::int64_t n : {0, 1, 1000000}) {
    const std::vector<Pair> values = hostArray<Pair>(n);
    ASSERT_EQ(values.size(), static_cast<std::size_t>(n));
    EXPECT_TRUE(std::all_of(values.begin(), values.end(), [](const Pair& value) {
      return value.first == 7 && value.second == -1;
    }));
  }
}

TEST(GroupByKeyTest, ListsEachItemOnceUnderItsKey) {
  for (const int num_items : {0, 1, 1000}) {
    const int num_keys = 37;
    const auto key_of = [](std::int64_t item) { return static_cast<int>(item * item % 36); };
    const Groups groups = groupByKey("test::groups", num_items, num_keys, key_of);
    ASSERT_EQ(groups.begin.size(), num_keys + 1u);
    EXPECT_EQ(groups.begin.front(), 0);
    EXPECT_EQ(groups.begin.back(), num_items);
    for (int key = 0; key < num_keys; ++key)
      for (int i = groups.begin[key]; i < groups.begin[key + 1]; ++i)
        EXPECT_EQ(key_of(groups.items[i]), key);
    std::vector<int> items = groups.items;
    std::sort(items.begin(), items.end());
    for (int item = 0; item < num_items; ++item)
      EXPECT_EQ(items[item], item);
  }
}

} // namespace
} // namespace brickwall
