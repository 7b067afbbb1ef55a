// Phase 4: the node boxes L_gns^q go to q in pairwise messages; what arrives from q is L_gnr^q.
#pragma once

#include "contact/base/exchange_plan.hpp"
#include "contact/search/exchange/box_words.hpp"
#include "contact/search/exchange/message_exchange.hpp"
#include "contact/search/exchange/partner_lists.hpp"
#include "contact/surface/construct_boxes.hpp"

namespace brickwall::contact {

struct RemoteNodeBoxes {
  std::vector<int> ranks; // Q_rcv, ascending
  std::vector<std::int64_t> offsets{0}; // [sender + 1] into boxes
  View<Box*> boxes{"contact::RemoteNodeBoxes::boxes", 0}; // L_gnr, by sender
  View<int*> senders{"contact::RemoteNodeBoxes::senders", 0}; // [box] index into ranks
  Box all; // holds all of them

  PartnerMessages messages;
  View<std::int64_t*> device_offsets{"contact::RemoteNodeBoxes::offsets", 0};
  std::int64_t size() const { return offsets.back(); }
};

// Collective among partners. `senders` are the ranks that send here: Q_rcv.
void exchangeNodeBoxes(const exec_space& space, MPI_Comm comm, const SurfaceBoxes& boxes,
                       const PartnerLists& nodes_to_send, const std::vector<int>& senders,
                       RemoteNodeBoxes& remote);

// The same for the cluster search: boxes of the listed nodes, in their order, one message per partner. Read what came by
// receivedNodeBox(messages.buffers.receive, i), i in messages.receiveOffsets().
void exchangeNodeBoxes(const exec_space& space, MPI_Comm comm, const Surface& surface,
                       double node_tolerance, const PartnerLists& nodes_to_send,
                       const std::vector<int>& senders, PartnerMessages& messages);

KOKKOS_INLINE_FUNCTION Box receivedNodeBox(const View<const std::int64_t*>& words, std::int64_t i) {
  return unpackBox(&words(i * box_words));
}

} // namespace brickwall::contact
