// Local node numbers: the ascending list of the global ids in use, and the place of each occurrence
// in it.
#pragma once

#include "io/mesh/mesh_part.hpp"

#include <algorithm>
#include <vector>

namespace brickwall::io {

// Place of `id` in the ascending list `ids`, which contains it.
inline int localIndex(const std::vector<global_id>& ids, global_id id) {
  return static_cast<int>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
}

inline std::vector<global_id> sortedDistinct(std::vector<global_id> ids) {
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
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

} // namespace brickwall::io
