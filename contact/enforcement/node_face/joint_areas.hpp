// Areas of the contacts in flush joints, in place of the tributary areas of eq. (11): with them, a
// uniform pressure gives the exact nodal forces of both sides, whatever the meshes; section 6.1 of
// theory.md. Found once, by findJointAreas().
#pragma once

#include "contact/base/backend.hpp"

namespace brickwall::contact {

struct JointAreas {
  static constexpr double max_share = 2; // largest area over the tributary area
  // Factor of k, eq. (11), so that the contacts of a joint are stable together also after a slip.
  static constexpr double stiffness_share = 0.62;
  // Factor of the bound (12). The contacts of a joint are stable together, so that exact areas need
  // 2 in place of 1; the rest is for the error of the areas.
  static constexpr double cap_factor = 2.01 * stiffness_share;

  View<const int*> row_begin, row_count; // [surface node]; empty if there are no joints
  View<const global_id*> sides; // opposing side [contact of a joint]
  View<const double*> areas; // a_i, length^2 [contact of a joint]

  KOKKOS_FORCEINLINE_FUNCTION bool isEmpty() const { return row_count.extent(0) == 0; }
  KOKKOS_FORCEINLINE_FUNCTION void prefetch(int node) const {
    if (isEmpty())
      return;
    brickwall::prefetch(&row_begin(node));
    brickwall::prefetch(&row_count(node));
  }
  // 0 if the node and the side have no joint.
  KOKKOS_FORCEINLINE_FUNCTION double areaOf(int node, global_id side) const {
    if (isEmpty())
      return 0;
    const int begin = row_begin(node), end = begin + row_count(node);
    for (int i = begin; i < end; ++i)
      if (sides(i) == side)
        return areas(i);
    return 0;
  }
};

} // namespace brickwall::contact
