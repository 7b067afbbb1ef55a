// Persistent buffers of messages between a rank and some partners, and the way that the messages
// take: one message per partner and direction; receives are posted, sends, one wait.
#pragma once

#include "contact/base/backend.hpp"
#include "contact/base/messages/message_path.hpp"
#include "contact/base/messages/peer_messages.hpp"
#include "contact/base/mpi.hpp"

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

namespace brickwall {

// A message that has come, of a size that the receiver did not know.
struct ProbedMessage {
  MPI_Message message;
  int words = 0;

  // Waits for it.
  ProbedMessage(int sender, int tag, MPI_Comm comm) {
    const Region region(waiting_region);
    MPI_Status status;
    checkMpi(MPI_Mprobe(sender, tag, comm, &message, &status), "MPI_Mprobe");
    checkMpi(MPI_Get_count(&status, MPI_INT64_T, &words), "MPI_Get_count");
  }
};

// Messages of 64-bit words that are under way.
class WordMessages {
public:
  void send(const std::int64_t* data, std::int64_t words, int receiver, int tag, MPI_Comm comm) {
    messagesSent().add(words);
    _requests.emplace_back();
    checkMpi(MPI_Isend(data, checkedInt(words, "message"), MPI_INT64_T, receiver, tag, comm,
                       &_requests.back()),
             "MPI_Isend");
  }
  void receive(std::int64_t* data, std::int64_t words, int sender, int tag, MPI_Comm comm) {
    _requests.emplace_back();
    checkMpi(MPI_Irecv(data, checkedInt(words, "message"), MPI_INT64_T, sender, tag, comm,
                       &_requests.back()),
             "MPI_Irecv");
  }
  void receive(std::int64_t* data, ProbedMessage& probed) {
    _requests.emplace_back();
    checkMpi(MPI_Imrecv(data, probed.words, MPI_INT64_T, &probed.message, &_requests.back()),
             "MPI_Imrecv");
  }
  void wait() { waitAll(_requests); }

private:
  std::vector<MPI_Request> _requests;
};

// In 64-bit words. Kernels write `send` and read `receive`; the rest is hidden.
class MessageBuffers {
public:
  MessageBuffers() = default;
  MessageBuffers(MessageBuffers&&) = default;
  MessageBuffers& operator=(MessageBuffers&&) = default;
  // A copy has buffers of its own. Partners copy alike.
  MessageBuffers(const MessageBuffers&) {}
  MessageBuffers& operator=(const MessageBuffers& other) {
    if (this != &other)
      *this = MessageBuffers();
    return *this;
  }

  // Words sent to and received from each partner, whose ranks are `partners`; offsets have partners
  // + 1 entries. Collective among partners: each must call it with matching sizes.
  void exchange(const exec_space& space, MPI_Comm comm, int tag, const std::vector<int>& partners,
                const std::vector<std::int64_t>& send_offsets,
                const std::vector<std::int64_t>& receive_offsets) {
    start(space, comm, tag, partners, send_offsets, receive_offsets);
    finish(space);
  }

  // The same in two parts: kernels that are launched between them run while the messages travel.
  // They must not write `send` nor read `receive`.
  void start(const exec_space& space, MPI_Comm comm, int tag, const std::vector<int>& partners,
             const std::vector<std::int64_t>& send_offsets,
             const std::vector<std::int64_t>& receive_offsets) {
    begin(comm, tag);
    if (partners.empty()) // nor a wait for the device
      return;
    growTo(space, receive, receive_offsets.back());
    connect(partners);
    const bool sends_empty = false; // both sides know the sizes
    split(partners, send_offsets, sends_empty, _sent, _peers_sent);
    split(partners, receive_offsets, sends_empty, _received, _peers_received);
    if (!_sent.empty() || !_received.empty()) {
      stage(space, send_offsets.back(), receive_offsets.back());
      // Also before the receives: the device may still be reading the data of the last exchange.
      space.fence();
      for (const MessageRange& range : _received)
        _messages.receive(receiveData() + range.begin, range.end - range.begin, range.rank, tag,
                          comm);
      for (const MessageRange& range : _sent)
        sendOne(range);
    }
    if (_path == MessagePath::peer)
      _peers->send(space, comm, tag, send, _peers_sent);
    copyOwn(space, partners, send_offsets, receive_offsets);
  }
  void finish(const exec_space& space) {
    _messages.wait();
    unstage(space);
    for (const MessageRange& range : _peers_received)
      _peers->announced(_comm, _tag, range.rank);
    if (!_peers_received.empty())
      _peers->receive(space, _comm, _tag, receive, _peers_received);
  }

  // The same with sizes that the receivers do not know. Sends a message, possibly empty, to each of
  // `receivers`; `receive_offsets` [sender + 1] are set from the sizes of the messages of
  // `senders`.
  void exchangeOfAnySize(const exec_space& space, MPI_Comm comm, int tag,
                         const std::vector<int>& receivers,
                         const std::vector<std::int64_t>& send_offsets,
                         const std::vector<int>& senders,
                         std::vector<std::int64_t>& receive_offsets) {
    begin(comm, tag);
    receive_offsets.assign(1, 0);
    if (receivers.empty() && senders.empty())
      return;
    std::vector<int>& partners = _partners;
    partners.clear();
    std::set_union(receivers.begin(), receivers.end(), senders.begin(), senders.end(),
                   std::back_inserter(partners));
    connect(partners);
    const bool sends_empty = true;
    split(receivers, send_offsets, sends_empty, _sent, _peers_sent);
    if (!_sent.empty()) {
      stage(space, send_offsets.back(), 0);
      space.fence();
    }
    for (const MessageRange& range : _sent)
      sendOne(range);
    if (_path == MessagePath::peer)
      _peers->send(space, comm, tag, send, _peers_sent);
    // All sizes first, so that the buffer grows before it receives data.
    _probed.clear();
    for (const int sender : senders)
      receive_offsets.push_back(receive_offsets.back() + (isPeer(sender)
                                                              ? _peers->announced(comm, tag, sender)
                                                              : probe(sender)));
    growTo(space, receive, receive_offsets.back());
    split(senders, receive_offsets, sends_empty, _received, _peers_received);
    if (!_received.empty()) {
      growStaging(0, receive_offsets.back());
      space.fence(); // `receive` may be read or freed until then
      for (std::size_t i = 0; i < _received.size(); ++i)
        _messages.receive(receiveData() + _received[i].begin, _probed[i]);
    }
    _messages.wait();
    unstage(space);
    if (_path == MessagePath::peer)
      _peers->receive(space, comm, tag, receive, _peers_received);
  }

  View<std::int64_t*> send{"base::MessageBuffers::send", 0};
  View<std::int64_t*> receive{"base::MessageBuffers::receive", 0};

private:
  using staging_view = Kokkos::View<std::int64_t*, staging_space>;

  void begin(MPI_Comm comm, int tag) {
    _comm = comm;
    _tag = tag;
    for (auto* ranges : {&_sent, &_received, &_peers_sent, &_peers_received})
      ranges->clear();
  }
  void connect(const std::vector<int>& partners) {
    if (_path != MessagePath::peer)
      return;
    if (!_peers)
      _peers = std::make_unique<PeerMessages>();
    _peers->connect(_comm, _tag, partners);
  }
  bool isPeer(int rank) const { return _path == MessagePath::peer && _peers->reaches(rank); }

  // Messages by MPI and those to peers; those of this rank to itself are in neither list.
  void split(const std::vector<int>& ranks, const std::vector<std::int64_t>& offsets,
             bool with_empty, std::vector<MessageRange>& by_mpi,
             std::vector<MessageRange>& to_peers) const {
    const int own = rankOf(_comm); // it may be among them
    for (std::size_t p = 0; p < ranks.size(); ++p)
      if (ranks[p] != own && (with_empty || offsets[p + 1] > offsets[p]))
        (isPeer(ranks[p]) ? to_peers : by_mpi).push_back({ranks[p], offsets[p], offsets[p + 1]});
  }
  void sendOne(const MessageRange& range) {
    _messages.send(sendData() + range.begin, range.end - range.begin, range.rank, _tag, _comm);
  }
  std::int64_t probe(int sender) {
    _probed.emplace_back(sender, _tag, _comm);
    return _probed.back().words;
  }
  void copyOwn(const exec_space& space, const std::vector<int>& partners,
               const std::vector<std::int64_t>& send_offsets,
               const std::vector<std::int64_t>& receive_offsets) {
    const int own = rankOf(_comm);
    for (std::size_t p = 0; p < partners.size(); ++p)
      if (partners[p] == own)
        copyRange(space, receive, receive_offsets[p], send, send_offsets[p],
                  send_offsets[p + 1] - send_offsets[p]);
  }

  template <class To, class From>
  static void copyRange(const exec_space& space, const To& to, std::int64_t to_begin,
                        const From& from, std::int64_t from_begin, std::int64_t n) {
    const auto part = [n](std::int64_t begin) {
      return std::make_pair(static_cast<std::size_t>(begin), static_cast<std::size_t>(begin + n));
    };
    if (n > 0)
      Kokkos::deep_copy(space, Kokkos::subview(to, part(to_begin)),
                        Kokkos::subview(from, part(from_begin)));
  }
  bool isStaged() const { return _path != MessagePath::direct; }
  void stage(const exec_space& space, std::int64_t num_send, std::int64_t num_receive) {
    growStaging(num_send, num_receive);
    if (isStaged())
      for (const MessageRange& range : _sent)
        copyRange(space, _staged_send, range.begin, send, range.begin, range.end - range.begin);
  }
  void unstage(const exec_space& space) {
    if (isStaged())
      for (const MessageRange& range : _received)
        copyRange(space, receive, range.begin, _staged_receive, range.begin,
                  range.end - range.begin);
  }
  void growStaging(std::int64_t num_send, std::int64_t num_receive) {
    if (!isStaged())
      return;
    if (static_cast<std::int64_t>(_staged_send.extent(0)) < num_send)
      _staged_send = staging_view("base::MessageBuffers::staged_send", num_send + num_send / 4);
    if (static_cast<std::int64_t>(_staged_receive.extent(0)) < num_receive)
      _staged_receive =
          staging_view("base::MessageBuffers::staged_receive", num_receive + num_receive / 4);
  }
  std::int64_t* sendData() { return isStaged() ? _staged_send.data() : send.data(); }
  std::int64_t* receiveData() { return isStaged() ? _staged_receive.data() : receive.data(); }

  MessagePath _path = chooseMessagePath();
  std::unique_ptr<PeerMessages> _peers; // of the path of that name
  staging_view _staged_send, _staged_receive;
  WordMessages _messages;
  std::vector<ProbedMessage> _probed;
  MPI_Comm _comm = MPI_COMM_NULL; // of the exchange under way, as are all below
  int _tag = 0;
  std::vector<int> _partners;
  std::vector<MessageRange> _sent, _received, _peers_sent, _peers_received; // [message]
};

} // namespace brickwall
