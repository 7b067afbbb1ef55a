// Pairwise messages whose sizes and partners change from step to step. The sizes are announced to
// the receivers in a message of their own, or found when the messages arrive. The pattern is kept:
// later messages can be sent along it in both directions.
#pragma once

#include "contact/base/messages/exchange_plan.hpp"

#include <vector>

namespace brickwall::contact {

class PartnerMessages {
public:
  // Collective among partners. Announces to each of `receivers` how many rows it will get
  // (send_offsets[p+1] - send_offsets[p]) and returns the offsets of the rows that `senders` have
  // for this rank. Both lists ascend; p is in the senders of q if and only if q is in the receivers
  // of p.
  const std::vector<std::int64_t>& announceSizes(MPI_Comm comm, int tag,
                                                 const std::vector<int>& receivers,
                                                 const std::vector<std::int64_t>& send_offsets,
                                                 const std::vector<int>& senders);

  // Collective among partners. announceSizes() and forward() in one message per partner and
  // direction, whose size the receiver probes. buffers.send holds send_offsets.back() rows of
  // `width` words. Returns the offsets of the rows received.
  const std::vector<std::int64_t>& forwardOfAnySize(const exec_space& space, MPI_Comm comm, int tag,
                                                    int width, const std::vector<int>& receivers,
                                                    const std::vector<std::int64_t>& send_offsets,
                                                    const std::vector<int>& senders);

  // Collective among partners. Sends buffers.send and fills buffers.receive, `width` words a row,
  // with the sizes of the last announceSizes() or forwardOfAnySize(); grow and fill buffers.send
  // first.
  void forward(const exec_space& space, MPI_Comm comm, int tag, int width);

  // The opposite direction: buffers.send holds a row for each row received, buffers.receive gets
  // one for each row sent.
  void reverse(const exec_space& space, MPI_Comm comm, int tag, int width);

  const std::vector<int>& senders() const { return _senders; }
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
  WordMessages _sizes;
};

} // namespace brickwall::contact
