// Input of the energy-neutral scheme from the host code.
#pragma once

#include "contact/enforcement/law/pair_forces.hpp"
#include "contact/enforcement/selection/touched_nodes.hpp"

#include <functional>

namespace brickwall::contact {

// Sets the flags [ghost] of the ghosts that contacts of this rank act on, and returns them.
using GhostsInUse = std::function<View<const unsigned char*>()>;

struct NeutralInput {
  // Accelerations by all other forces at x^{n+1}, including gravity, 0 where the motion is
  // prescribed [surface node][xyz]; only those of the listed nodes are read. Called once in steps
  // with contact forces on any rank, and never in others.
  std::function<View<const double* [3]>(const NodeList&)> accelerations;
  // Collective. Turns partial sums into totals at every copy of a node: reverseSum, then the
  // shared-node sum.
  std::function<void(const ContactForces&)> sum_forces;
  // Collective. ghost_values(ghost, 3 * corner + xyz) = the owner's values(its surface node, xyz).
  std::function<void(const View<const double* [3]>& values, const View<double* [12]>& ghost_values)>
      share_with_ghosts;
  // Collective. Adds to the list, which has the nodes that contacts of this rank act on, those to
  // which sum_forces adds forces of other ranks, and those whose values share_with_ghosts sends.
  // From then on both may leave out other nodes, and ghosts whose flags are 0. Optional, for any
  // scheme: without it several ranks visit all nodes.
  std::function<void(const GhostsInUse&, TouchedNodes&)> list_shared;
  // Enforcement::enforce() does not wait for the last corrections: the caller will call
  // completeSums().
  bool completes_sums = false;

  bool isComplete() const { return accelerations && sum_forces && share_with_ghosts; }
};

} // namespace brickwall::contact
