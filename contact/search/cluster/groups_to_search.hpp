// Groups of nodes that follow each other in the kept order, by whether ghosts may be near them.
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

enum class GroupKind { all, far, near }; // from partners

// The groups that a kernel searches.
struct GroupsToSearch {
  GroupKind kind = GroupKind::all;
  GroupsNearPartners near_partners;

  KOKKOS_INLINE_FUNCTION bool has(int group, int num_groups) const {
    return kind == GroupKind::all ||
           near_partners.has(group, num_groups) == (kind == GroupKind::near);
  }
};

} // namespace brickwall::contact
