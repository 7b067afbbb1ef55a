// contact/surface/merge_runs.hpp: runs of any number and size become one list, stably.
#include "contact/surface/merge_runs.hpp"

#include <gtest/gtest.h>

#include <random>

namespace brickwall {
namespace {

TEST(SortRuns, SortsStablyWhateverTheRuns) {
  using Entry = std::pair<int, int>; // key, place
  const auto less = [](const Entry& a, const Entry& b) { return a.first < b.first; };
  std::mt19937 random(1);
  for (int num_runs = 0; num_runs < 12; ++num_runs) {
    std::vector<Entry> entries;
    std::vector<std::size_t> ends;
    for (int run = 0; run < num_runs; ++run) {
      const std::size_t begin = entries.size();
      for (unsigned i = random() % 4 == 0 ? 0 : random() % 50; i > 0; --i)
        entries.emplace_back(static_cast<int>(random() % 40), 0);
      if (run % 3 != 0)
        std::sort(entries.begin() + static_cast<std::ptrdiff_t>(begin), entries.end());
      ends.push_back(entries.size());
    }
    for (std::size_t i = 0; i < entries.size(); ++i)
      entries[i].second = static_cast<int>(i);
    std::vector<Entry> expected = entries;
    std::stable_sort(expected.begin(), expected.end(), less);
    sortRuns(entries, ends, less);
    EXPECT_EQ(entries, expected) << num_runs;
  }
}

} // namespace
} // namespace brickwall
