// Sorting on the host of lists that consist of ascending runs, such as what several ranks have
// sent.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace brickwall {

// Sorts `entries` stably, whose runs end at `ends`; the last is the size. Runs need not ascend, but
// cost less if they do: then the time is that of log(number of runs) copies.
template <class T, class Less>
void sortRuns(std::vector<T>& entries, std::vector<std::size_t> ends, const Less& less) {
  const auto at = [](std::vector<T>& list, std::size_t i) {
    return list.begin() + static_cast<std::ptrdiff_t>(i);
  };
  std::size_t begin = 0;
  for (const std::size_t end : ends) {
    if (!std::is_sorted(at(entries, begin), at(entries, end), less))
      std::stable_sort(at(entries, begin), at(entries, end), less);
    begin = end;
  }
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end()); // empty runs
  std::vector<T> merged(ends.size() > 1 ? entries.size() : 0);
  while (ends.size() > 1) {
    std::vector<std::size_t> longer;
    begin = 0;
    for (std::size_t i = 0; i < ends.size(); i += 2) {
      const std::size_t middle = ends[i], end = ends[std::min(i + 1, ends.size() - 1)];
      std::merge(at(entries, begin), at(entries, middle), at(entries, middle), at(entries, end),
                 at(merged, begin), less);
      longer.push_back(end);
      begin = end;
    }
    entries.swap(merged);
    ends.swap(longer);
  }
}

} // namespace brickwall
