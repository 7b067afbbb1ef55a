#include "contact/search/exchange/node_box_exchange.hpp"

#include "contact/base/region.hpp"
#include "contact/base/tags.hpp"

namespace brickwall::contact {
namespace {

void packBoxes(const exec_space& space, const View<const Box*>& boxes, const PartnerLists& lists,
               MessageBuffers& buffers) {
  growTo(space, buffers.send, lists.size() * box_words);
  const auto words = buffers.send;
  const View<const int*> rows = lists.rows;
  Kokkos::parallel_for(
      "contact::exchangeNodeBoxes::pack", rangePolicy(space, lists.size()),
      KOKKOS_LAMBDA(const std::int64_t i) { packBox(boxes(rows(i)), &words(i * box_words)); });
}

void packBoxes(const exec_space& space, const SweptBoxes& surface, double tolerance,
               const PartnerLists& lists, MessageBuffers& buffers) {
  growTo(space, buffers.send, lists.size() * box_words);
  const auto words = buffers.send;
  const View<const int*> nodes = lists.rows;
  const auto x_old = surface.coordinates_old, x_new = surface.coordinates_new;
  Kokkos::parallel_for(
      "contact::exchangeNodeBoxes::pack_nodes", rangePolicy(space, lists.size()),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int node = nodes(i);
        packBox(nodeBox(rowOf(x_old, node), rowOf(x_new, node), tolerance), &words(i * box_words));
      });
}

void unpackBoxes(const exec_space& space, RemoteNodeBoxes& remote) {
  growTo(space, remote.boxes, remote.size());
  growTo(space, remote.senders, remote.size());
  copyToDevice(space, remote.offsets, remote.device_offsets);
  const View<const std::int64_t*> offsets = remote.device_offsets;
  const auto num_senders = static_cast<int>(remote.ranks.size());
  const View<const std::int64_t*> words = remote.messages.buffers.receive;
  const auto boxes = remote.boxes;
  const auto senders = remote.senders;
  Kokkos::parallel_reduce(
      "contact::exchangeNodeBoxes::unpack", rangePolicy(space, remote.size()),
      KOKKOS_LAMBDA(const std::int64_t i, Box& all) {
        const Box box = receivedNodeBox(words, i);
        boxes(i) = box;
        senders(i) = partnerOf(offsets, num_senders, i);
        all.include(box);
      },
      PlusReducer<Box>(remote.all));
}

} // namespace

void exchangeNodeBoxes(const exec_space& space, MPI_Comm comm, const SurfaceBoxes& boxes,
                       const PartnerLists& nodes_to_send, const std::vector<int>& senders,
                       RemoteNodeBoxes& remote) {
  const Region region("contact::exchangeNodeBoxes");
  const Region timer("contact::search::node_box_exchange");
  auto& messages = remote.messages;
  remote.ranks = senders;
  remote.offsets = messages.announceSizes(comm, tags::node_box_counts, nodes_to_send.ranks,
                                          nodes_to_send.offsets, senders);
  packBoxes(space, boxes.node_boxes, nodes_to_send, messages.buffers);
  messages.forward(space, comm, tags::node_boxes, box_words);

  checkedInt(remote.size(), "node boxes received");
  unpackBoxes(space, remote);
}

void exchangeNodeBoxes(const exec_space& space, MPI_Comm comm, const SweptBoxes& surface,
                       double node_tolerance, const PartnerLists& nodes_to_send,
                       const std::vector<int>& senders, PartnerMessages& messages) {
  const Region region("contact::exchangeNodeBoxes");
  const Region timer("contact::search::node_box_exchange");
  packBoxes(space, surface, node_tolerance, nodes_to_send, messages.buffers);
  messages.forwardOfAnySize(space, comm, tags::node_boxes, box_words, nodes_to_send.ranks,
                            nodes_to_send.offsets, senders);
  checkedInt(messages.receiveOffsets().back(), "node boxes received");
}

} // namespace brickwall::contact
