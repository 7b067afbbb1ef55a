// Local numbers: the ascending list of the global ids in use, and the place of each occurrence in
// it; and the ways in which entities reach their ranks before they are numbered.
#pragma once

#include "contact/base/mpi.hpp"
#include "io/mesh/mesh_part.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace brickwall::io {

// Place of `id` in the ascending list `ids`, which contains it.
inline int localIndex(const std::vector<global_id>& ids, global_id id) {
  return static_cast<int>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
}

// Local number of each of `ids` in the ascending list `numbered`.
inline std::vector<int> localIndices(const std::vector<global_id>& numbered,
                                     const std::vector<global_id>& ids) {
  std::vector<int> local;
  local.reserve(ids.size());
  for (const global_id id : ids)
    local.push_back(localIndex(numbered, id));
  return local;
}

// Sends values[i] to the rank ranks[i]; returns those for this rank, in the order of senders.
// Collective.
template <class T>
std::vector<T> sendTo(MPI_Comm comm, const std::vector<int>& ranks, const std::vector<T>& values) {
  std::vector<std::vector<T>> lists(sizeOf(comm));
  for (std::size_t i = 0; i < values.size(); ++i)
    lists[ranks[i]].push_back(values[i]);
  return joined(exchangeByRank(comm, lists));
}

// Numbers for `count` entities of each rank, rank by rank: the first of this rank, and how many
// there are. Collective.
inline std::pair<global_id, global_id> numbersFor(MPI_Comm comm, std::int64_t count) {
  const auto counts =
      joined(exchangeByRank(comm, std::vector<std::vector<std::int64_t>>(sizeOf(comm), {count})));
  const auto mine = counts.begin() + rankOf(comm);
  return {std::accumulate(counts.begin(), mine, global_id(0)),
          std::accumulate(counts.begin(), counts.end(), global_id(0))};
}

} // namespace brickwall::io
