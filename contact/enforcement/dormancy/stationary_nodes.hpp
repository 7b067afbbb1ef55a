// A node is stationary if its old and its new coordinates in this step are, bit by bit, the new
// ones of the last step. A face is stationary if all its corners are. A stationary node need not be
// tested again if all its candidates are stationary and none could be in contact in the last step:
// boxes that do not move do not grow, so each pair was tested in that step, with the same geometry.
#pragma once

#include "contact/enforcement/dormancy/surface_motion.hpp"

namespace brickwall::contact {

// For kernels. Ghosts are never stationary.
struct StationaryFlags {
  bool is_any = false; // otherwise nodes and faces are not valid
  View<const unsigned char*> nodes, faces; // [node], [own face] 1: stationary
  // [node] 1: in the last step no pair of its row could be in contact
  View<unsigned char*> known_apart;

  // Whether no pair of a row can be in contact, since nothing has changed.
  KOKKOS_INLINE_FUNCTION bool isKnownApart(const CandidatePairs& pairs, std::int64_t row) const {
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
  // Flags of the nodes and faces of `surface`. With a list `point_to_node`, the first nodes are
  // those of another surface, whose motion update() receives, and node point_to_node.extent(0) + f
  // stands for face f.
  StationaryNodes(const std::string& label, const SweptBoxes& surface,
                  const View<const int*>& point_to_node = {});

  // `motion` must include this step. `test` holds the tolerances of the search that found this
  // step's pairs; if they have grown, no row is known to be apart.
  void update(const exec_space& space, const SweptBoxes& surface, const SurfaceMotion& motion,
              const StepTest& test);

  const StationaryFlags& flags() const { return _flags; }
  // Whether all nodes were stationary in this call and in the last one, and the tolerances have not
  // grown. Without ghosts and without contacts, nothing can then have changed.
  bool isUnchanged() const { return _is_unchanged; }

private:
  View<const int*> _point_to_node;
  bool _is_all_stationary = false, _is_unchanged = false;
  StepTest _last_test;
  View<unsigned char*> _nodes; // of a surface with a list
  View<unsigned char*> _faces;
  StationaryFlags _flags;
};

} // namespace brickwall::contact
