// How much memory a scene needs, from counts of elements, nodes and faces.
#pragma once

#include <cstdint>

namespace brickwall::miniapp {

struct SceneBytes {
  double device = 0; // bytes of the Views that the time loop uses, all ranks
  double host_and_device = 0; // these and what the host keeps for output, at the peak of the set-up
};

inline SceneBytes estimateBytes(std::int64_t elements, std::int64_t nodes, std::int64_t faces,
                                bool congruent) {
  // Views: connectivity and ids per element, stored geometry if not congruent; coordinates, u, v, mass, forces and ids
  // per node; boxes, tree, ids, attributes and candidate pairs per face.
  const double per_element = 32 + 8 + 4 + 8 + (congruent ? 0 : 370);
  const double per_node = 3 * 24 + 8 + 12 * 8 + 8 + 1 + 24;
  const double per_face = 700;
  const double device = per_element * static_cast<double>(elements) +
                        per_node * static_cast<double>(nodes) +
                        per_face * static_cast<double>(faces);
  // The host keeps the mesh and the output buffers, 9 values an element and 11 a node in double, and needs as much again
  // while it sets up: together 480 B an element made up the measured 665 MB of W(8), 30 MB for the program included.
  const double host =
      480 * static_cast<double>(elements) + (36 + 11 * 8) * static_cast<double>(nodes);
  return {device, device + host};
}

} // namespace brickwall::miniapp
