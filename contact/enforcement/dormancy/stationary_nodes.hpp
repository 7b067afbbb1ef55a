// What stands where it stood: nodes whose coordinates have not changed by a bit since the last step, nor in this one, and faces all
// of whose corners are such. A still node whose candidates could not be touched, and are still too, needs no second look: its
// pairs are among those of the last step, since boxes that do not move any more do not grow, and they are as they were.
#pragma once

#include "contact/enforcement/dormancy/surface_motion.hpp"

namespace brickwall::contact {

// For kernels. Ghosts are never still.
struct StationaryFlags {
  bool is_any = false; // else nodes and faces tell nothing
  View<const unsigned char*> nodes, faces; // [node], [own face] 1: still
  View<unsigned char*>
      known_apart; // [node] 1: in the last step no pair of its row could be touched

  // Whether nothing has changed for a row of candidates.
  KOKKOS_INLINE_FUNCTION bool isClear(const CandidatePairs& pairs, std::int64_t row) const {
    const int node = pairs.node(row);
    if (!is_any || !known_apart(node) || !nodes(node))
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

class StationaryNodes {
public:
  StationaryNodes() = default;
  // Flags of the nodes and faces of `surface`. With a list `point_to_node` its first nodes are those of another surface, whose
  // motion update() is told, and node point_to_node.extent(0) + f stands for face f.
  StationaryNodes(const std::string& label, const SweptBoxes& surface,
                  const View<const int*>& point_to_node = {});

  // `motion` has seen this step. `test`: tolerances of the search that found this step's pairs; if they have grown, nothing is
  // clear.
  void update(const exec_space& space, const SweptBoxes& surface, const SurfaceMotion& motion,
              const StepTest& test);

  const StationaryFlags& flags() const { return _flags; }
  // Whether all points stood still, in this call and in the last one, and the tolerances have not grown: without ghosts all
  // contacts are then what they were, if they are none.
  bool isUnchanged() const { return _is_unchanged; }

  // A part of update(), public only for its kernels.
  void setFlags(const exec_space& space, const SweptBoxes& surface, const SurfaceMotion& motion);

private:
  View<const int*> _point_to_node;
  bool _is_all_still = false, _is_unchanged = false;
  StepTest _last_test;
  View<unsigned char*> _nodes; // of a surface with a list
  View<unsigned char*> _faces;
  StationaryFlags _flags;
};

} // namespace brickwall::contact
