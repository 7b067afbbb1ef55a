// Fields of node-to-face contact for output, from the contact history after a step.
#pragma once

#include "contact/base/fixed_point.hpp"
#include "contact/enforcement/law/pair_forces.hpp"

namespace brickwall::contact {

// Normal forces with damping, without friction and fading, as partial sums in quanta
// (ContactForces).
// `faces` and `history` as the last enforce() left them.
ContactForces normalForces(const exec_space& space, const FaceAccess& faces,
                           const ContactHistory& history, const Quantum& quantum);

// Tangential motion [surface node][xyz], length, of each owned node in this step as seen from the
// face on which it presses hardest; 0 at nodes that press on none.
View<double* [3]> slipMotion(const exec_space& space, const FaceAccess& faces,
                             const ContactHistory& history);

// Adds to `distance` [surface node], length, by how much each owned node has slipped in this step
// on the face on which it presses hardest: the part |t_trial - t|/k_t of the tangential motion that
// the return mapping of friction, eq. (21), takes from the spring; without friction all of that
// motion.
void addSlip(const exec_space& space, const FaceAccess& faces, const ContactHistory& history,
             const View<double*>& distance);

// Number of candidate pairs of each face: of own faces in column 0 of `own` [face][3], of ghosts in
// column 0 of `of_ghosts` [ghost][12], as partial sums for reverseSum(); the other columns are 0.
struct CandidateCounts {
  View<std::int64_t* [3]> own;
  View<std::int64_t* [12]> of_ghosts;
};
CandidateCounts countCandidates(const exec_space& space, const FaceAccess& faces,
                                const CandidatePairs& pairs);

} // namespace brickwall::contact
