// Mean planes, bodies and ids of faces, kept from step to step: planes of stationary faces are not
// recomputed, and where most rows of candidates are dormant, only faces of the other rows are.
#pragma once

#include "contact/enforcement/dormancy/idle_rows.hpp"
#include "contact/enforcement/node_face/node_faces.hpp"

namespace brickwall::contact {

class FaceRecords {
public:
  FaceRecords(const exec_space& space, const Surface& surface, const NodeFaces& node_faces);

  // Collective. Updates the records of all faces that rows which are awake refer to.
  void update(const exec_space& space, const FaceAccess& faces, const CandidatePairs& pairs,
              const IdleRows& idle, NodeFaces& node_faces);
  // To be called instead in a step that needs no records although faces have moved.
  void invalidate(const exec_space& space);

  const View<FaceRecord*>& records() const { return _records; } // own, remote, ghost faces

private:
  View<FaceRecord*> _records;
  View<unsigned char*> _is_current; // [own face] its record is that of the last step
  View<unsigned char*> _is_requested; // [own face], 0 between calls
};

} // namespace brickwall::contact
