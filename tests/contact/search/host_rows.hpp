// Host access to candidate rows, for tests.
#pragma once

#include "contact/surface/surface.hpp"

#include <vector>

namespace brickwall::contact::test {

template <class ViewType>
auto onHost(const ViewType& view) {
  return Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), view);
}

// The rows of candidates on the host.
class HostRows {
public:
  explicit HostRows(const CandidatePairs& pairs)
      : _nodes(onHost(pairs.row_nodes)), _blocks(onHost(pairs.block_begin)),
        _rows(onHost(pairs.row_begin)), _faces(onHost(pairs.faces)) {}
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
