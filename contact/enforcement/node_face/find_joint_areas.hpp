// Finds the flush joints of a surface and the areas of their contacts; section 6.1 of theory.md.
#pragma once

#include "contact/base/mpi.hpp"
#include "contact/enforcement/node_face/node_face_kinematics.hpp"
#include "contact/enforcement/selection/neutral_input.hpp"

namespace brickwall::contact {

// Collective. At coordinates_new, from the candidates `pairs` of this step and the records of all
// faces. Empty on all ranks if the tributary areas serve, as where meshes match.
JointAreas findJointAreas(const exec_space& space, const Communicator& comm,
                          const NodeFaceKinematics& kinematics, const FaceAccess& faces,
                          const CandidatePairs& pairs, const NeutralInput& host);

} // namespace brickwall::contact
