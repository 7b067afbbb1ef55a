// Phase 6: the faces L_ges^q are sent to q with their data, packed in one message per partner.
#pragma once

#include "contact/search/exchange/message_exchange.hpp"
#include "contact/search/exchange/partner_lists.hpp"
#include "contact/surface/surface.hpp"

namespace brickwall::contact {

struct FaceMigration {
  GhostFaces ghosts;
  PartnerMessages messages;
};

// Collective among partners. Sends the listed faces and receives the ghosts of this rank from
// `senders` (Q_snd): one message per partner and direction, of 30 words a face and its attributes.
// With `announces_sizes` the sizes are sent in a message before.
void migrateFaces(const exec_space& space, MPI_Comm comm, const SweptBoxes& surface,
                  const PartnerLists& faces_to_send, const std::vector<int>& senders,
                  int num_attributes, bool announces_sizes, FaceMigration& migration);

} // namespace brickwall::contact
