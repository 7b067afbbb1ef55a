// Host access to candidate rows, for tests.
#pragma once

#include "contact/base/to_device.hpp"
#include "contact/surface/surface.hpp"

#include <vector>

namespace brickwall::contact::test {

// The rows of candidates on the host.
class HostRows {
public:
  explicit HostRows(const CandidatePairs& pairs)
      : _nodes(toHost(pairs.row_nodes)), _blocks(toHost(pairs.block_begin)),
        _rows(toHost(pairs.row_begin)), _faces(toHost(pairs.faces)) {}
  int node(int row) const { return _nodes(row); }
  struct Entry {
    std::int64_t place; // in CandidatePairs::faces
    int face;
  };
  std::vector<Entry> entries(int row) const {
    const int block = row / CandidatePairs::rows_per_block;
    std::vector<Entry> entries;
    for (int i = _rows(row + block); i < _rows(row + block + 1); ++i)
      entries.push_back({_blocks(block) + i, _faces(_blocks(block) + i)});
    return entries;
  }
  std::vector<int> faces(int row) const {
    std::vector<int> faces;
    for (const Entry& entry : entries(row))
      faces.push_back(entry.face);
    return faces;
  }

private:
  View<int*>::HostMirror _nodes;
  View<std::int64_t*>::HostMirror _blocks;
  View<int*>::HostMirror _rows, _faces;
};

} // namespace brickwall::contact::test
