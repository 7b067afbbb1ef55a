// What stands where it stood: nodes whose coordinates have not changed by a bit since the last step, nor in this one, and faces all
// of whose corners are such. A still node whose candidates could not be touched, and are still too, needs no second look: its
// pairs are among those of the last step, since boxes that do not move any more do not grow, and they are as they were.
#pragma once

#include "contact/surface.hpp"

#include <cstring>

namespace brickwall::contact {

// 0 and -0 differ: what is kept then is what would be computed.
KOKKOS_INLINE_FUNCTION bool sameBits(double a, double b) {
  std::int64_t p, q;
  memcpy(&p, &a, sizeof p);
  memcpy(&q, &b, sizeof q);
  return p == q;
}

// For kernels. Ghosts are never still.
struct StillFlags {
  View<const unsigned char*> nodes, faces; // [node], [own face] 1: still
  View<unsigned char*> clear; // [node] 1: in the last step no pair of its row could be touched

  // Whether nothing has changed for a row of candidates.
  KOKKOS_INLINE_FUNCTION bool isClear(const CandidatePairs& pairs, std::int64_t row) const {
    const int node = pairs.node(row);
    if (!clear(node) || !nodes(node))
      return false;
    const std::int64_t end = pairs.end(row);
    unsigned all = 1;
    const int num_faces = static_cast<int>(faces.extent(0));
    for (std::int64_t p = pairs.begin(row); p < end; ++p) {
      const int face = pairs.faces(p);
      all &= face < num_faces ? faces(face) : 0u;
    }
    return all != 0;
  }
};

class StillParts {
public:
  StillParts() = default;
  // Nodes from `num_points` on stand for faces: node num_points + f is still if face f is.
  StillParts(const exec_space& space, const std::string& label, const Surface& surface,
             int num_points);

  // Compares the coordinates with those of the last call. `test`: tolerances of the search that found this step's pairs; if
  // they have grown, nothing is clear.
  void update(const exec_space& space, const Surface& surface, const StepTest& test);

  const StillFlags& flags() const { return _flags; }
  // Whether all points stood still, in this call and in the last one, and the tolerances have not grown: without ghosts all
  // contacts are then what they were, if they are none.
  bool isUnchanged() const { return _is_unchanged; }

private:
  int _num_points = 0;
  bool _is_all_still = false, _is_unchanged = false;
  StepTest _last_test;
  View<double* [3]> _last; // coordinates of the last call [point][xyz]
  View<unsigned char*> _nodes, _faces;
  StillFlags _flags;
};

} // namespace brickwall::contact
