// Items grouped by a number: a counting sort by the threads of the host, for set-up.
#pragma once

#include "contact/base/to_device.hpp"

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

} // namespace brickwall
