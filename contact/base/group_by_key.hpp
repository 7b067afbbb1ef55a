// Items grouped by a number, by a counting sort with the threads of the host, and disjoint sets;
// for set-up.
#pragma once

#include "contact/base/to_device.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

namespace brickwall {

struct Groups {
  std::vector<int> begin; // [key] and the end: place of the first item of the key
  std::vector<int> items; // in no particular order within a key
};

// Groups items [0, num_items) by key_of(item) in [0, num_keys).
template <class KeyOf>
Groups groupByKey(const std::string& label, int num_items, int num_keys, const KeyOf& key_of) {
  Groups groups;
  groups.begin.assign(static_cast<std::size_t>(num_keys) + 1, 0);
  groups.items = hostArray<int>(num_items);
  int* const begin = groups.begin.data();
  int* const items = groups.items.data();
  parallelOnHost(label + "::count", num_items,
                 [=](std::int64_t item) { Kokkos::atomic_add(&begin[key_of(item)], 1); });
  std::partial_sum(groups.begin.begin(), groups.begin.end(), groups.begin.begin());
  parallelOnHost(label + "::fill", num_items, [=](std::int64_t item) {
    items[Kokkos::atomic_fetch_add(&begin[key_of(item)], -1) - 1] = static_cast<int>(item);
  });
  return groups;
}

// Disjoint sets of 0 .. n - 1, with path halving.
class DisjointSets {
public:
  explicit DisjointSets(std::size_t n) : _parent(n) {
    std::iota(_parent.begin(), _parent.end(), 0);
  }
  int rootOf(int i) {
    while (_parent[i] != i)
      i = _parent[i] = _parent[_parent[i]];
    return i;
  }
  void join(int a, int b) { _parent[rootOf(a)] = rootOf(b); }
  // [i] the lowest of `values` in the set of i.
  template <class T>
  std::vector<T> lowestOfSets(std::vector<T> values) {
    const int n = static_cast<int>(values.size());
    for (int i = 0; i < n; ++i)
      values[rootOf(i)] = std::min(values[rootOf(i)], values[i]);
    for (int i = 0; i < n; ++i)
      values[i] = values[rootOf(i)];
    return values;
  }

private:
  std::vector<int> _parent;
};

} // namespace brickwall
