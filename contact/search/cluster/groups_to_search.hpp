// Groups of nodes that follow each other in the kept order, told apart by whether ghosts may be near.
#pragma once

#include "contact/base/backend.hpp"

namespace brickwall::contact {

// Groups with nodes near the surface of a partner. The nodes of all others are near no ghost.
struct GroupsNearPartners {
  static constexpr int nodes_of_group = 32;
  View<const unsigned*> masks; // [partner][group] those of its nodes that are near the partner
  int num_partners = 0;

  KOKKOS_INLINE_FUNCTION bool has(int group, int num_groups) const {
    unsigned near = 0;
    for (int p = 0; p < num_partners; ++p)
      near |= masks(std::int64_t(p) * num_groups + group);
    return near != 0;
  }
};

// The groups that a kernel searches.
struct GroupsToSearch {
  enum Kind { all, far, near };
  Kind kind = all;
  GroupsNearPartners near_partners;

  KOKKOS_INLINE_FUNCTION bool has(int group, int num_groups) const {
    return kind == all || near_partners.has(group, num_groups) == (kind == near);
  }
};

} // namespace brickwall::contact
