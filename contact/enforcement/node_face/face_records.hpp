// What is asked of faces first, kept from step to step: planes of faces that have not moved stay as they are, and where most rows
// of candidates sleep, only the faces of those that do not are worked out.
#pragma once

#include "contact/enforcement/dormancy/sleeping_blocks.hpp"
#include "contact/enforcement/dormancy/stationary_nodes.hpp"
#include "contact/enforcement/node_face/node_faces.hpp"

namespace brickwall::contact {

class FaceRecords {
public:
  FaceRecords() = default;
  FaceRecords(const exec_space& space, const Surface& surface, const NodeFaces& node_faces);

  // Collective. The records of this step, of faces that some row which is awake asks for.
  void update(const exec_space& space, const FaceAccess& faces, const CandidatePairs& pairs,
              const StationaryFlags& still, const SleepingBlocks& sleeping, NodeFaces& node_faces);
  // Instead, in a step that needs none in which faces have moved.
  void forget(const exec_space& space);

  const View<FaceRecord*>& records() const { return _records; } // own, remote, ghost faces

private:
  View<FaceRecord*> _records;
  View<unsigned char*> _is_current; // [own face] its record is that of the last step
  View<unsigned char*> _is_wanted; // [own face], 0 between calls
};

} // namespace brickwall::contact
