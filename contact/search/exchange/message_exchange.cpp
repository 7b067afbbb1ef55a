#include "contact/search/exchange/message_exchange.hpp"

#include <iterator>

namespace brickwall::contact {

const std::vector<std::int64_t>&
PartnerMessages::announceSizes(MPI_Comm comm, int tag, const std::vector<int>& receivers,
                               const std::vector<std::int64_t>& send_offsets,
                               const std::vector<int>& senders) {
  setPartners(receivers, send_offsets, senders);
  _counts.resize(receivers.size() + senders.size());
  std::int64_t* const expected = _counts.data() + receivers.size();
  for (std::size_t p = 0; p < senders.size(); ++p)
    _sizes.receive(expected + p, 1, senders[p], tag, comm);
  for (std::size_t p = 0; p < receivers.size(); ++p) {
    _counts[p] = send_offsets[p + 1] - send_offsets[p];
    _sizes.send(&_counts[p], 1, receivers[p], tag, comm);
  }
  _sizes.wait();
  _receive_offsets.assign(1, 0);
  for (std::size_t p = 0; p < senders.size(); ++p)
    _receive_offsets.push_back(_receive_offsets.back() + expected[p]);
  return _receive_offsets;
}

const std::vector<std::int64_t>& PartnerMessages::forwardOfAnySize(
    const exec_space& space, MPI_Comm comm, int tag, int width, const std::vector<int>& receivers,
    const std::vector<std::int64_t>& send_offsets, const std::vector<int>& senders) {
  setPartners(receivers, send_offsets, senders);
  buffers.exchangeOfAnySize(space, comm, tag, receivers,
                            wordOffsets(send_offsets, width, _send_words), senders, _receive_words);
  _receive_offsets.resize(_receive_words.size());
  for (std::size_t p = 0; p < _receive_words.size(); ++p)
    _receive_offsets[p] = _receive_words[p] / width;
  return _receive_offsets;
}

void PartnerMessages::forward(const exec_space& space, MPI_Comm comm, int tag, int width) {
  spread(_receivers, _send_offsets, width, _send_words);
  spread(_senders, _receive_offsets, width, _receive_words);
  buffers.exchange(space, comm, tag, _partners, _send_words, _receive_words);
}

void PartnerMessages::reverse(const exec_space& space, MPI_Comm comm, int tag, int width) {
  spread(_senders, _receive_offsets, width, _send_words);
  spread(_receivers, _send_offsets, width, _receive_words);
  buffers.exchange(space, comm, tag, _partners, _send_words, _receive_words);
}

// The merged list is kept as long as the partners stay the same.
void PartnerMessages::setPartners(const std::vector<int>& receivers,
                                  const std::vector<std::int64_t>& send_offsets,
                                  const std::vector<int>& senders) {
  _send_offsets = send_offsets;
  if (receivers == _receivers && senders == _senders)
    return;
  _receivers = receivers;
  _senders = senders;
  _partners.clear();
  std::set_union(_receivers.begin(), _receivers.end(), _senders.begin(), _senders.end(),
                 std::back_inserter(_partners));
}

// Turns the row offsets of `ranks` into word offsets of all partners; partners not in `ranks` get
// no words.
void PartnerMessages::spread(const std::vector<int>& ranks,
                             const std::vector<std::int64_t>& offsets, int width,
                             std::vector<std::int64_t>& words) const {
  words.assign(1, 0);
  std::size_t p = 0;
  for (const int partner : _partners) {
    std::int64_t rows = 0;
    if (p < ranks.size() && ranks[p] == partner) {
      rows = offsets[p + 1] - offsets[p];
      ++p;
    }
    words.push_back(words.back() + rows * width);
  }
}

} // namespace brickwall::contact
