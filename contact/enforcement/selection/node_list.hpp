// The surface nodes that a kernel is to visit: some, listed, or all.
#pragma once

#include "contact/base/backend.hpp"

namespace brickwall::contact {

struct NodeList {
  std::int64_t count = 0;
  View<const int*> nodes; // [place], each node once, in any order; null: nodes 0 .. count - 1

  static NodeList allOf(std::int64_t num_nodes) { return {num_nodes, {}}; }
  bool isAll() const { return nodes.data() == nullptr; }
  KOKKOS_INLINE_FUNCTION int operator()(std::int64_t place) const {
    return nodes.data() == nullptr ? static_cast<int>(place) : nodes(place);
  }
};

} // namespace brickwall::contact
