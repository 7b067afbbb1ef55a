// Phase 4: the node boxes L_gns^q are sent to rank q in pairwise messages; those received from q
// are L_gnr^q.
#pragma once

#include "contact/base/box.hpp"
#include "contact/search/exchange/message_exchange.hpp"
#include "contact/search/exchange/partner_lists.hpp"
#include "contact/surface/construct_boxes.hpp"

namespace brickwall::contact {

// A box as message words: lower xyz, upper xyz.
constexpr int box_words = 6;

KOKKOS_INLINE_FUNCTION void packBox(const Box& box, std::int64_t* words) {
  for (int d = 0; d < 3; ++d) {
    words[d] = toWord(box.lower[d]);
    words[3 + d] = toWord(box.upper[d]);
  }
}
KOKKOS_INLINE_FUNCTION Box unpackBox(const std::int64_t* words) {
  Box box;
  for (int d = 0; d < 3; ++d) {
    fromWord(words[d], box.lower[d]);
    fromWord(words[3 + d], box.upper[d]);
  }
  return box;
}
KOKKOS_INLINE_FUNCTION Box receivedNodeBox(const View<const std::int64_t*>& words, std::int64_t i) {
  return unpackBox(&words(i * box_words));
}

struct RemoteNodeBoxes {
  std::vector<int> ranks; // Q_rcv, ascending
  std::vector<std::int64_t> offsets{0}; // [sender + 1] into boxes
  View<Box*> boxes{"contact::RemoteNodeBoxes::boxes", 0}; // L_gnr, by sender
  View<int*> senders{"contact::RemoteNodeBoxes::senders", 0}; // [box] index into ranks
  Box all; // the union of all boxes

  PartnerMessages messages;
  View<std::int64_t*> device_offsets{"contact::RemoteNodeBoxes::offsets", 0};
  std::int64_t size() const { return offsets.back(); }
};

// Collective among partners. `senders` are the ranks that send boxes to this rank: Q_rcv. The sizes
// are announced in a message of their own.
void exchangeNodeBoxes(const exec_space& space, MPI_Comm comm, const SurfaceBoxes& boxes,
                       const PartnerLists& nodes_to_send, const std::vector<int>& senders,
                       RemoteNodeBoxes& remote);

// Collective among partners. The same for the cluster search, in one message per partner: the boxes
// of the listed nodes, in the order of the list. The boxes received are
// receivedNodeBox(messages.buffers.receive, i), i as in messages.receiveOffsets().
void exchangeNodeBoxes(const exec_space& space, MPI_Comm comm, const SweptBoxes& surface,
                       double node_tolerance, const PartnerLists& nodes_to_send,
                       const std::vector<int>& senders, PartnerMessages& messages);

} // namespace brickwall::contact
