// Phase 6: the faces L_ges^q with their data go to q, packed in one message per partner; the reactions on the ghosts
// go the way back.
#pragma once

#include "contact/base/mpi.hpp"
#include "contact/search/exchange/message_exchange.hpp"
#include "contact/search/exchange/partner_lists.hpp"
#include "contact/surface/search_config.hpp"
#include "contact/surface/surface.hpp"

namespace brickwall::contact {

struct FaceMigration {
  GhostFaces ghosts;
  PartnerMessages messages;
};

// Collective among partners. Sends the listed faces and receives the ghosts of this rank from `senders` (Q_snd): one
// message per partner and direction, of 30 words a face and its attributes. `paper` and `reference` tell their sizes in
// a message before.
void migrateFaces(const exec_space& space, MPI_Comm comm, const Surface& surface,
                  const PartnerLists& faces_to_send, const std::vector<int>& senders,
                  int num_attributes, SearchMethod method, FaceMigration& migration);

// Collective among partners. node_values(corner j of the face, :) += ghost_values(ghost, 3 * j + :) of all ghosts of own faces.
// `faces_sent` as of the last migration.
void reverseSumGhostValues(const exec_space& space, MPI_Comm comm, const PartnerLists& faces_sent,
                           const View<const int* [4]>& face_to_nodes,
                           const View<const std::int64_t* [12]>& ghost_values,
                           FaceMigration& migration, const View<std::int64_t* [3]>& node_values);

} // namespace brickwall::contact
