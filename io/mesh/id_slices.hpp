// Contiguous slices of the ids 0 .. total - 1, one per rank. A rank first reads or generates the
// entities of its slice, and it is the home of their ids in a rendezvous, where all ranks that know
// something about an id meet.
#pragma once

#include <algorithm>
#include <cstdint>

namespace brickwall::io {

struct IdSlices {
  std::int64_t total = 0;
  int num_ranks = 1;

  std::int64_t begin(int rank) const {
    return total / num_ranks * rank + std::min<std::int64_t>(rank, total % num_ranks);
  }
  std::int64_t end(int rank) const { return begin(rank + 1); }
  int rankOf(std::int64_t id) const {
    const std::int64_t small = total / num_ranks, larger = total % num_ranks;
    const std::int64_t in_larger = larger * (small + 1); // the first ranks have one more
    if (id < in_larger)
      return static_cast<int>(id / (small + 1));
    return static_cast<int>(larger + (id - in_larger) / small);
  }
};

} // namespace brickwall::io
