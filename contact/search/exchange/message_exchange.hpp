// Pairwise messages whose sizes and partners change every step: the receivers are told the sizes first, or find them
// out when the messages come.
#pragma once

#include "contact/base/exchange_plan.hpp"

#include <vector>

namespace brickwall::contact {

class PartnerMessages {
public:
  // Collective among partners. Tells each of `receivers` how many rows it will get (send_offsets[p+1] -
  // send_offsets[p]) and returns the offsets of the rows that `senders` have for this rank. Both lists ascend; p is in
  // q's senders if and only if q is in p's receivers.
  const std::vector<std::int64_t>& agreeOnSizes(MPI_Comm comm, int tag,
                                                const std::vector<int>& receivers,
                                                const std::vector<std::int64_t>& send_offsets,
                                                const std::vector<int>& senders);

  // Collective among partners. agreeOnSizes() and exchange() in one message per partner and direction: its size comes with
  // it. buffers.send holds send_offsets.back() rows of `width` words. Returns the offsets of the rows received.
  const std::vector<std::int64_t>& exchangeOfAnySize(const exec_space& space, MPI_Comm comm,
                                                     int tag, int width,
                                                     const std::vector<int>& receivers,
                                                     const std::vector<std::int64_t>& send_offsets,
                                                     const std::vector<int>& senders);

  // Collective among partners. Sends buffers.send and fills buffers.receive, of `width` words a row, sizes as agreed
  // last; grow and fill buffers.send first.
  void exchange(const exec_space& space, MPI_Comm comm, int tag, int width);

  // The way back: what was received is sent (buffers.send, received rows in order), and the other way round.
  void exchangeReverse(const exec_space& space, MPI_Comm comm, int tag, int width);

  int numPartners() const { return static_cast<int>(_partners.size()); }
  const std::vector<std::int64_t>& receiveOffsets() const { return _receive_offsets; }

  MessageBuffers buffers;

private:
  void setPartners(const std::vector<int>& receivers, const std::vector<std::int64_t>& send_offsets,
                   const std::vector<int>& senders);
  void spread(const std::vector<int>& ranks, const std::vector<std::int64_t>& offsets, int width,
              std::vector<std::int64_t>& words) const;

  std::vector<int> _receivers, _senders, _partners; // _partners: both, ascending
  std::vector<std::int64_t> _send_offsets{0}, _receive_offsets{0}, _counts;
  std::vector<std::int64_t> _send_words, _receive_words; // [partner + 1]
  std::vector<MPI_Request> _requests;
};

} // namespace brickwall::contact
