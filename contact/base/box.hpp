// Axis-aligned bounding box of doubles with closed overlap (touching boxes overlap). The empty box
// has lower > upper and overlaps nothing.
#pragma once

#include "contact/base/vec3.hpp"

#include <cmath>

namespace brickwall {

struct Box {
  double lower[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
  double upper[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

  KOKKOS_INLINE_FUNCTION void include(const Vec3& p) {
    for (int d = 0; d < 3; ++d) {
      lower[d] = minOf(lower[d], p[d]);
      upper[d] = maxOf(upper[d], p[d]);
    }
  }
  KOKKOS_INLINE_FUNCTION void include(const Box& b) {
    for (int d = 0; d < 3; ++d) {
      lower[d] = minOf(lower[d], b.lower[d]);
      upper[d] = maxOf(upper[d], b.upper[d]);
    }
  }
  KOKKOS_INLINE_FUNCTION void inflate(double margin) {
    for (int d = 0; d < 3; ++d) {
      lower[d] -= margin;
      upper[d] += margin;
    }
  }
  // Without branches: in a search either answer is likely.
  KOKKOS_INLINE_FUNCTION bool overlaps(const Box& b) const {
    return (lower[0] <= b.upper[0]) & (b.lower[0] <= upper[0]) & (lower[1] <= b.upper[1]) &
           (b.lower[1] <= upper[1]) & (lower[2] <= b.upper[2]) & (b.lower[2] <= upper[2]);
  }
  // An empty box is contained in all others.
  KOKKOS_INLINE_FUNCTION bool contains(const Box& b) const {
    bool inside = true;
    for (int d = 0; d < 3; ++d)
      inside &= lower[d] <= b.lower[d] && b.upper[d] <= upper[d];
    return inside || b.empty();
  }
  KOKKOS_INLINE_FUNCTION bool empty() const { return !(lower[0] <= upper[0]); }
  KOKKOS_INLINE_FUNCTION Vec3 centroid() const {
    return {0.5 * lower[0] + 0.5 * upper[0], 0.5 * lower[1] + 0.5 * upper[1],
            0.5 * lower[2] + 0.5 * upper[2]};
  }
  // Reduction with PlusReducer<Box>: the union.
  KOKKOS_INLINE_FUNCTION Box& operator+=(const Box& b) {
    include(b);
    return *this;
  }
};

} // namespace brickwall
