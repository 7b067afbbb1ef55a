// Memory of a scene, estimated from its numbers of elements, nodes and faces.
#pragma once

#include <cstdint>

namespace brickwall::miniapp {

struct SceneBytes {
  double device = 0; // Views of the time loop, all ranks
  double host_and_device = 0; // with the host's data for output, at the peak of the set-up
};

inline SceneBytes estimateBytes(std::int64_t elements, std::int64_t nodes, std::int64_t faces,
                                bool congruent) {
  // Per element: connectivity and ids, and geometry unless congruent. Per node: coordinates, u, v,
  // mass, forces and ids. Per face: boxes, tree, ids, attributes and candidate pairs.
  const double per_element = 32 + 8 + 4 + 8 + (congruent ? 0 : 370);
  const double per_node = 3 * 24 + 8 + 12 * 8 + 8 + 1 + 24;
  const double per_face = 700;
  const double device = per_element * static_cast<double>(elements) +
                        per_node * static_cast<double>(nodes) +
                        per_face * static_cast<double>(faces);
  // The host keeps the mesh and output buffers of 9 doubles per element and 11 per node, and needs
  // as much again during the set-up. 480 B per element reproduce the 665 MB measured for W(8),
  // including 30 MB for the program.
  const double host =
      480 * static_cast<double>(elements) + (36 + 11 * 8) * static_cast<double>(nodes);
  return {device, device + host};
}

} // namespace brickwall::miniapp
