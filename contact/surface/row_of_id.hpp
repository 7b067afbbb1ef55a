// The row of each id in a list of distinct ids, on the host, for set-up. Lists that ascend cost one
// pass.
#pragma once

#include "contact/base/to_device.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace brickwall::contact {

class RowOfId {
public:
  static constexpr int none = -1;

  explicit RowOfId(const View<const global_id*>& ids) {
    const auto host = toHost(ids);
    _rows.reserve(host.extent(0));
    for (std::size_t row = 0; row < host.extent(0); ++row)
      _rows.emplace_back(host(row), static_cast<int>(row));
    if (!std::is_sorted(_rows.begin(), _rows.end()))
      std::sort(_rows.begin(), _rows.end());
  }

  // As find(): fast if the id is that of `row`, or of one of the next two.
  int findNear(int row, global_id id) const {
    for (int next = row; next < row + 3 && next < static_cast<int>(_rows.size()); ++next)
      if (_rows[next].first == id && _rows[next].second == next)
        return next;
    return find(id);
  }

  int find(global_id id) const {
    const auto found = std::lower_bound(_rows.begin(), _rows.end(), std::make_pair(id, 0));
    return found != _rows.end() && found->first == id ? found->second : none;
  }

private:
  std::vector<std::pair<global_id, int>> _rows; // ascending
};

} // namespace brickwall::contact
