// Which rank holds an id: a directory that is distributed over the ranks.
#pragma once

#include "contact/base/mpi.hpp"
#include "contact/surface/merge_runs.hpp"

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

namespace brickwall::contact {

// The part of a rank: the ids whose remainder by the number of ranks is its number.
class IdHolders {
public:
  static constexpr int none = -1;

  // Collective. `held` are the ids of this rank; no other rank lists them.
  IdHolders(const Communicator& comm, const std::vector<global_id>& held) {
    const int num_ranks = sizeOf(comm);
    std::vector<std::vector<global_id>> listed(num_ranks);
    for (const global_id id : held)
      listed[id % num_ranks].push_back(id);
    std::vector<std::size_t> ends;
    const auto lists = exchangeByRank(comm, std::move(listed));
    for (int q = 0; q < num_ranks; ++q) {
      for (const global_id id : lists[q])
        _holders.emplace_back(id, q);
      ends.push_back(_holders.size());
    }
    sortRuns(_holders, std::move(ends), std::less<>());
  }

  // The rank that holds an id of this part, or none.
  int operator()(global_id id) const {
    const auto at = std::lower_bound(_holders.begin(), _holders.end(), std::make_pair(id, 0));
    return at != _holders.end() && at->first == id ? at->second : none;
  }

private:
  std::vector<std::pair<global_id, int>> _holders; // ascending
};

} // namespace brickwall::contact
