// The point that pushes a face: a surface node, or a point of the edge between two of them.
#pragma once

#include "contact/base/backend.hpp"

namespace brickwall::contact {

struct ContactPoint {
  int node[2] = {-1, -1}; // surface nodes
  double share = 0; // of the second node; 0 for a node

  KOKKOS_INLINE_FUNCTION bool isNode() const { return node[0] == node[1]; }
};
KOKKOS_INLINE_FUNCTION ContactPoint atNode(int node) {
  ContactPoint point;
  point.node[0] = point.node[1] = node;
  return point;
}

} // namespace brickwall::contact
