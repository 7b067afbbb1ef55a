// Places of a list that threads extend at the same time (contact/base/lanes.hpp).
#include "contact/base/lanes.hpp"
#include "contact/base/to_device.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace brickwall {

// Threads take different numbers of places, some of them none, and mark theirs.
KOKKOS_INLINE_FUNCTION int placesOf(std::int64_t thread) {
  return static_cast<int>(thread * thread % 7);
}
void markPlaces(int num_threads, const View<std::int64_t>& count, const View<int*>& threads) {
  Kokkos::parallel_for(
      "test::markPlaces", rangePolicy(exec_space(), num_threads),
      KOKKOS_LAMBDA(const std::int64_t thread) {
        if (placesOf(thread) == 4)
          return;
        const std::int64_t first = reservePlaces(count.data(), placesOf(thread));
        for (int k = 0; k < placesOf(thread); ++k)
          threads(first + k) = static_cast<int>(thread);
      });
}

TEST(ReservePlacesTest, GivesConsecutivePlacesToEveryThread) {
  constexpr int num_threads = 5001;
  std::vector<int> expected;
  for (int thread = 0; thread < num_threads; ++thread)
    for (int k = 0; k < placesOf(thread) && placesOf(thread) != 4; ++k)
      expected.push_back(thread);
  const View<std::int64_t> count("test::count");
  const View<int*> threads("test::threads", expected.size());
  markPlaces(num_threads, count, threads);
  EXPECT_EQ(static_cast<std::size_t>(toHost(count)()), expected.size());
  const auto found = toHost(threads);
  std::vector<int> sorted(found.data(), found.data() + expected.size());
  std::vector<int> runs = sorted; // the places of a thread follow each other
  runs.erase(std::unique(runs.begin(), runs.end()), runs.end());
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(sorted, expected);
  expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
  EXPECT_EQ(runs.size(), expected.size());
}

} // namespace brickwall
