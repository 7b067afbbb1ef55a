// Radix sort, Morton codes and the tree against plain loops.
#include "contact/base/to_device.hpp"
#include "contact/search/spatial/bvh_query.hpp"
#include "tests/contact/search/search_cases.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace brickwall::contact::test {
namespace {

Box boxOf(const Vec3& a, const Vec3& b) {
  Box box;
  box.include(a);
  box.include(b);
  return box;
}

void setKeys(const std::vector<std::uint64_t>& keys, SortedKeys& sorted) {
  sorted.grow(exec_space(), static_cast<std::int64_t>(keys.size()));
  const auto host_keys = Kokkos::create_mirror_view(sorted.keys);
  const auto host_values = Kokkos::create_mirror_view(sorted.values);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    host_keys(i) = keys[i];
    host_values(i) = static_cast<int>(i);
  }
  Kokkos::deep_copy(sorted.keys, host_keys);
  Kokkos::deep_copy(sorted.values, host_values);
}

TEST(RadixSortTest, EqualsAStableSort) {
  Random random(3);
  SortedKeys sorted;
  for (const int n : {0, 1, 2, 3, 100, 5000, 40000})
    for (const int bits : {1, 7, 20, 33, 63, 64}) {
      std::vector<std::uint64_t> keys(static_cast<std::size_t>(n));
      const std::uint64_t mask = ~std::uint64_t(0) >> (64 - bits);
      for (auto& key : keys)
        key = ((static_cast<std::uint64_t>(random.below(1 << 30)) << 34) ^
               static_cast<std::uint64_t>(random.below(random.chance(0.5) ? 8 : 1 << 30))) &
              mask;
      std::vector<int> order(keys.size());
      std::iota(order.begin(), order.end(), 0);
      std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return keys[a] < keys[b]; });
      setKeys(keys, sorted);
      sortByKey(exec_space(), n, bits, sorted);
      const auto found = toHost(sorted.values);
      const auto found_keys = toHost(sorted.keys);
      for (int i = 0; i < n; ++i) {
        ASSERT_EQ(found(i), order[i]) << n << " keys of " << bits << " bits";
        ASSERT_EQ(found_keys(i), keys[order[i]]);
      }
    }
}

TEST(RadixSortTest, BitsHoldAllKeysBelowTheLimit) {
  EXPECT_EQ(bitsFor(0), 0);
  EXPECT_EQ(bitsFor(1), 0);
  EXPECT_EQ(bitsFor(2), 1);
  EXPECT_EQ(bitsFor(256), 8);
  EXPECT_EQ(bitsFor(257), 9);
  EXPECT_EQ(bitsFor(~std::uint64_t(0)), 64);
}

TEST(MortonTest, InterleavesTheBitsOfTheCells) {
  // One cell per unit length.
  const MortonGrid grid(boxOf({0, 0, 0}, {2097151, 2097151, 2097151}));
  EXPECT_EQ(mortonCode(grid, {0, 0, 0}), 0u);
  EXPECT_EQ(mortonCode(grid, {1, 0, 0}), 4u);
  EXPECT_EQ(mortonCode(grid, {0, 1, 0}), 2u);
  EXPECT_EQ(mortonCode(grid, {0, 0, 1}), 1u);
  EXPECT_EQ(mortonCode(grid, {3, 0, 2}), 044u | 010u);
  EXPECT_EQ(mortonCode(grid, {2097151, 2097151, 2097151}), ~std::uint64_t(0) >> 1);
}

TEST(MortonTest, PointsOutsideAndNotFiniteGetACode) {
  const Box unit = boxOf({0, 0, 0}, {1, 1, 1});
  const std::uint64_t last = ~std::uint64_t(0) >> 1;
  EXPECT_EQ(mortonCode(MortonGrid(unit), {-5, -1e300, -HUGE_VAL}), 0u);
  EXPECT_EQ(mortonCode(MortonGrid(unit), {5, 1e300, HUGE_VAL}), last);
  EXPECT_EQ(mortonCode(MortonGrid(unit), Box().centroid()), 0u); // NaN
  EXPECT_EQ(mortonCode(MortonGrid(Box()), {1, 2, 3}), 0u);
}

TEST(FloatBoundsTest, RoundingKeepsTheOrderOfBounds) {
  Random random(5);
  std::vector<double> values{
      0.0,    -0.0, 1e-320, -1e-320,  1e-46,     -1e-46, 1e300,
      -1e300, 0.1,  3.5e38, HUGE_VAL, -HUGE_VAL, 1.0,    std::nextafter(1.0, 2.0)};
  for (int i = 0; i < 10000; ++i)
    values.push_back(std::ldexp(random.real(-1, 1), random.below(400) - 200));
  std::sort(values.begin(), values.end());
  for (std::size_t i = 0; i < values.size(); ++i) {
    ASSERT_TRUE(std::isfinite(toFloat(values[i]))) << values[i];
    ASSERT_LE(toFloat(values[i > 0 ? i - 1 : 0]), toFloat(values[i]));
  }
}

TEST(FloatBoundsTest, TheBoxOfEverythingFindsASingleItemOnce) {
  const Box everything = boxOf({-1e300, -1e300, -1e300}, {1e300, 1e300, 1e300});
  const Box unit = boxOf({0, 0, 0}, {0, 0, 0});
  TreeNode node;
  node.setBox(0, FloatBounds::of(unit));
  node.setBox(1, FloatBounds());
  bool overlaps[2];
  FloatQuery(everything).test(node, overlaps);
  EXPECT_TRUE(overlaps[0]);
  EXPECT_FALSE(overlaps[1]);
  FloatQuery(Box()).test(node, overlaps);
  EXPECT_FALSE(overlaps[0] || overlaps[1]);
}

TEST(FloatBoundsTest, BoxesThatTouchAtEitherZeroOverlap) {
  const Box below = boxOf({-1, -1, -1}, {-0.0, -0.0, -0.0}), above = boxOf({0, 0, 0}, {1, 1, 1});
  TreeNode node;
  node.setBox(0, FloatBounds::of(below));
  node.setBox(1, FloatBounds::of(above));
  for (const Box& query : {below, above}) {
    bool overlaps[2];
    FloatQuery(query).test(node, overlaps);
    EXPECT_TRUE(overlaps[0] && overlaps[1]);
  }
}

Box randomBox(Random& random, double size) {
  const Vec3 at{random.real(0, 10), random.real(0, 10), random.real(0, 10)};
  return boxOf(at, at + Vec3{random.real(0, size), random.real(0, size), random.real(0, size)});
}

struct Overlaps {
  View<const Box*> queries, items;
  KOKKOS_INLINE_FUNCTION OverlapsRow operator()(int query) const {
    return {queries(query), items.data()};
  }
};

void expectAllOverlaps(const std::vector<Box>& items, const std::vector<Box>& queries, bool sorted,
                       Bvh& tree, QueryResults& results) {
  const exec_space space;
  Box all;
  for (const Box& box : items)
    all.include(box);
  const View<const Box*> device_items = toDevice(space, "test", items),
                         device_queries = toDevice(space, "test", queries);
  const int num_queries = static_cast<int>(queries.size());
  buildTree(space, device_items, static_cast<int>(items.size()), all, tree);
  QueryOrder order;
  const BoxOfRow box_of{device_queries};
  sortQueries(space, box_of, num_queries, all, order);
  queryTree(space, "test", tree, num_queries, box_of, Overlaps{device_queries, device_items},
            sorted ? &order : nullptr, results);
  const auto begin = toHost(results.begin);
  const auto count = toHost(results.count);
  const auto found = toHost(results.items);
  for (int q = 0; q < num_queries; ++q) {
    std::vector<int> row, expected;
    for (std::int64_t i = begin(q); i < begin(q) + count(q); ++i)
      row.push_back(found(i));
    std::sort(row.begin(), row.end());
    for (std::size_t i = 0; i < items.size(); ++i)
      if (queries[q].overlaps(items[i]))
        expected.push_back(static_cast<int>(i));
    ASSERT_EQ(row, expected) << "query " << q << " of " << items.size() << " items";
  }
}

TEST(TreeTest, QueriesFindWhatAllPairsFind) {
  Random random(11);
  Bvh tree;
  QueryResults results; // persistent, as between steps
  for (const int num_items : {0, 1, 2, 3, 4, 7, 64, 1000, 9000})
    for (const int num_queries : {0, 1, 50, 2000}) {
      std::vector<Box> items, queries;
      for (int i = 0; i < num_items; ++i)
        items.push_back(randomBox(random, i % 50 == 0 ? 3.0 : 0.3));
      for (int i = 0; i < num_queries; ++i)
        queries.push_back(i % 9 == 0 ? Box() : randomBox(random, 0.5));
      expectAllOverlaps(items, queries, num_items % 2 == 0, tree, results);
    }
}

TEST(TreeTest, EqualCodesAreToldApartByIndex) {
  Bvh tree;
  QueryResults results;
  Random random(2);
  std::vector<Box> items(5000, randomBox(random, 1.0)); // one code for all
  for (std::size_t i = 0; i < items.size(); i += 3)
    items[i] = randomBox(random, 0.01);
  expectAllOverlaps(items, {items[1], items[3], Box()}, true, tree, results);
}

TEST(TreeTest, AnOverflowingResultBufferIsGrownAndTheSearchRepeated) {
  Bvh tree;
  QueryResults results;
  Random random(2);
  const std::vector<Box> items(100, randomBox(random, 1.0)), queries(40, items[0]);
  expectAllOverlaps(items, queries, true, tree, results);
  EXPECT_EQ(results.num_passes, 2);
  EXPECT_EQ(results.num_rows, 4000);
  expectAllOverlaps(items, queries, true, tree, results);
  EXPECT_EQ(results.num_passes, 1); // the buffer keeps its greatest size
}

} // namespace
} // namespace brickwall::contact::test
