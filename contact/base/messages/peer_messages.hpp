// Messages between ranks that reach each other's memory (peer_memory.hpp). The sender copies its
// words to a slot that others can open, and sends by MPI where they are and when they will be
// there; the receiver lets its device wait and copy. Neither host waits for its device. A sender
// has two slots, taken in turn; a receiver says when it has launched its copy, and the device of
// the sender waits for that copy before the slot is filled again. What others can open is not
// freed, since it cannot be known when all have closed it: later PeerMessages use it again.
#pragma once

#include "contact/base/messages/message_path.hpp"
#include "contact/base/messages/peer_memory.hpp"
#include "contact/base/mpi.hpp"

#include <cstring>
#include <exception>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace brickwall {

// Words [begin, end) of a buffer that go to or come from a rank.
struct MessageRange {
  int rank;
  std::int64_t begin, end;
};

class PeerMessages {
public:
  PeerMessages();
  PeerMessages(const PeerMessages&) = delete;
  PeerMessages& operator=(const PeerMessages&) = delete;
  ~PeerMessages();

  // Collective among partners: finds out which of `ranks` and this rank reach each other, where
  // that is not known.
  void connect(MPI_Comm comm, int tag, const std::vector<int>& ranks);
  bool reaches(int rank) const { return at(rank).is_reached; }

  // Sends ranges of `words` to ranks that are reached, also empty ones.
  void send(const exec_space& space, MPI_Comm comm, int tag, const View<std::int64_t*>& words,
            const std::vector<MessageRange>& to);
  // The number of words that a rank has sent and that receive() will take. Waits for its message.
  std::int64_t announced(MPI_Comm comm, int tag, int rank);
  // Copies what announced() has told of.
  void receive(const exec_space& space, MPI_Comm comm, int tag, const View<std::int64_t*>& words,
               const std::vector<MessageRange>& from);

private:
  // Added to the tag of an exchange; tags.hpp has no tag above 99.
  enum Step { greet = 1000, answer = 2000, announce = 3000, confirm = 4000 };
  struct Greeting {
    char host[MPI_MAX_PROCESSOR_NAME] = {};
    std::int64_t capacity = 0;
    peer::Handle memory, event;
  };
  struct Announcement {
    std::int64_t begin = 0, words = 0, capacity = 0;
    std::int64_t generation = 0; // of the sender's slots
    std::int64_t slot = 0;
    peer::Handle memory, event;
  };
  struct Confirmation {
    peer::Handle event; // of the receiver: it has taken all words that it has been told of
  };
  // What is open of another rank.
  struct Peer {
    bool is_reached = false;
    Announcement announced;
    std::int64_t generation[2] = {0, 0};
    const std::int64_t* memory[2] = {nullptr, nullptr};
    peer::Event has_words[2] = {}, has_taken = {};
  };
  struct Slot {
    std::int64_t* data = nullptr;
    std::int64_t capacity = 0, generation = 0;
    peer::Handle memory, event;
    peer::Event has_words = {};
    std::vector<Announcement> announcements;
    std::vector<int> receivers;
    std::vector<Confirmation> confirmations; // of the receivers
    std::vector<MPI_Request> sends, receives;
  };
  // What others can open.
  struct Shared {
    Slot slots[2]; // [number of the exchange modulo 2]
    peer::Event has_taken = {};
    Confirmation confirmation;
  };
  static std::vector<std::unique_ptr<Shared>>& unused() { // of this process
    static std::vector<std::unique_ptr<Shared>> list;
    return list;
  }
  // What this process has opened; it stays open.
  template <class T>
  static T& openedOf(const peer::Handle& handle) {
    static std::map<std::string, T> list;
    return list[std::string(handle.bytes, sizeof handle.bytes)];
  }
  static const std::int64_t* openMemory(const peer::Handle& handle, std::int64_t words) {
    auto& memory = openedOf<const std::int64_t*>(handle);
    return memory = memory != nullptr ? memory : peer::open(handle, words);
  }
  static peer::Event openEvent(const peer::Handle& handle) {
    auto& event = openedOf<peer::Event>(handle);
    return event = event != nullptr ? event : peer::openEvent(handle);
  }

  const Peer& at(int rank) const {
    static const Peer unknown;
    const auto found = _peers.find(rank);
    return found == _peers.end() ? unknown : found->second;
  }
  static void grow(Slot& slot, std::int64_t words);
  void awaitReaders(const exec_space& space, Slot& slot);
  void giveUp();
  static void check(bool did, const char* what) {
    if (!did)
      throw Error(ExitCode::internal, std::string("peer messages: ") + what +
                                          " failed; BRICKWALL_MESSAGES=staged does without");
  }
  template <class T>
  static void isend(const T& value, int rank, int tag, MPI_Comm comm, MPI_Request& request) {
    checkMpi(MPI_Isend(&value, sizeof value, MPI_BYTE, rank, tag, comm, &request), "MPI_Isend");
  }
  template <class T>
  static void irecv(T& value, int rank, int tag, MPI_Comm comm, MPI_Request& request) {
    checkMpi(MPI_Irecv(&value, sizeof value, MPI_BYTE, rank, tag, comm, &request), "MPI_Irecv");
  }

  std::map<int, Peer> _peers;
  std::unique_ptr<Shared> _shared;
  std::int64_t _num_sent = 0; // exchanges
  std::vector<MPI_Request> _confirms;
};

inline PeerMessages::PeerMessages() {
  if (!unused().empty()) {
    _shared = std::move(unused().back());
    unused().pop_back();
    return;
  }
  _shared = std::make_unique<Shared>();
  _shared->has_taken = peer::makeEvent(_shared->confirmation.event);
  for (Slot& slot : _shared->slots) {
    slot.has_words = peer::makeEvent(slot.event);
    if (_shared->has_taken != nullptr && slot.has_words != nullptr)
      grow(slot, 1);
  }
}

// The memory before stays with this process.
inline void PeerMessages::grow(Slot& slot, std::int64_t words) {
  if (words <= slot.capacity)
    return;
  const std::int64_t capacity = maxOf(2 * words, +peer::least_words);
  slot.data = peer::allocate(capacity, slot.memory);
  slot.capacity = slot.data != nullptr ? capacity : 0;
  ++slot.generation;
}

inline void PeerMessages::connect(MPI_Comm comm, int tag, const std::vector<int>& ranks) {
  const int rank = rankOf(comm);
  std::vector<int> unknown;
  for (const int q : ranks)
    if (q != rank && _peers.find(q) == _peers.end())
      unknown.push_back(q);
  if (unknown.empty())
    return;
  const Region region("base::PeerMessages::connect");
  const std::size_t n = unknown.size();
  Greeting own;
  int length = 0;
  checkMpi(MPI_Get_processor_name(own.host, &length), "MPI_Get_processor_name");
  const Slot(&slots)[2] = _shared->slots;
  own.capacity = slots[0].capacity;
  own.memory = slots[0].memory;
  own.event = slots[0].event;
  const bool has_memory = slots[0].data != nullptr && slots[1].data != nullptr;
  std::vector<Greeting> greetings(n);
  std::vector<int> mine(n), theirs(n);
  std::vector<MPI_Request> requests(2 * n);
  for (std::size_t i = 0; i < n; ++i) {
    irecv(greetings[i], unknown[i], tag + greet, comm, requests[2 * i]);
    isend(own, unknown[i], tag + greet, comm, requests[2 * i + 1]);
  }
  waitAll(requests);
  for (std::size_t i = 0; i < n; ++i)
    mine[i] = has_memory && std::strcmp(own.host, greetings[i].host) == 0 &&
              openMemory(greetings[i].memory, greetings[i].capacity) != nullptr &&
              openEvent(greetings[i].event) != nullptr;
  requests.resize(2 * n);
  for (std::size_t i = 0; i < n; ++i) {
    irecv(theirs[i], unknown[i], tag + answer, comm, requests[2 * i]);
    isend(mine[i], unknown[i], tag + answer, comm, requests[2 * i + 1]);
  }
  waitAll(requests);
  for (std::size_t i = 0; i < n; ++i)
    _peers[unknown[i]].is_reached = mine[i] != 0 && theirs[i] != 0;
}

// Waits until the words that the slot holds have been read: the host for messages, the device for
// copies.
inline void PeerMessages::awaitReaders(const exec_space& space, Slot& slot) {
  waitAll(slot.sends);
  waitAll(slot.receives);
  for (std::size_t i = 0; i < slot.receivers.size(); ++i) {
    Peer& reader = _peers.at(slot.receivers[i]);
    if (reader.has_taken == nullptr)
      reader.has_taken = openEvent(slot.confirmations[i].event);
    check(reader.has_taken != nullptr && peer::waitFor(space, reader.has_taken),
          "waiting for a receiver");
  }
  slot.receivers.clear();
}

inline void PeerMessages::send(const exec_space& space, MPI_Comm comm, int tag,
                               const View<std::int64_t*>& words,
                               const std::vector<MessageRange>& to) {
  if (to.empty())
    return;
  const std::int64_t number = _num_sent++ % 2;
  Slot& slot = _shared->slots[number];
  awaitReaders(space, slot);
  std::int64_t size = 0;
  for (const MessageRange& range : to)
    size += range.end - range.begin;
  grow(slot, size);
  check(slot.data != nullptr, "allocating memory");
  const std::size_t n = to.size();
  slot.announcements.assign(n, Announcement());
  slot.confirmations.assign(n, Confirmation());
  slot.sends.resize(n);
  slot.receives.resize(n);
  std::int64_t begin = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::int64_t count = to[i].end - to[i].begin;
    if (count > 0)
      check(peer::copy(space, slot.data + begin, words.data() + to[i].begin, count), "copying");
    slot.announcements[i] = {begin,  count,       slot.capacity, slot.generation,
                             number, slot.memory, slot.event};
    begin += count;
  }
  check(peer::record(space, slot.has_words), "recording an event");
  for (std::size_t i = 0; i < n; ++i) {
    slot.receivers.push_back(to[i].rank);
    irecv(slot.confirmations[i], to[i].rank, tag + confirm, comm, slot.receives[i]);
    isend(slot.announcements[i], to[i].rank, tag + announce, comm, slot.sends[i]);
    messagesSent().add(to[i].end - to[i].begin);
  }
}

inline std::int64_t PeerMessages::announced(MPI_Comm comm, int tag, int rank) {
  const Region region(waiting_region);
  Announcement& announcement = _peers.at(rank).announced;
  checkMpi(MPI_Recv(&announcement, sizeof announcement, MPI_BYTE, rank, tag + announce, comm,
                    MPI_STATUS_IGNORE),
           "MPI_Recv");
  return announcement.words;
}

inline void PeerMessages::receive(const exec_space& space, MPI_Comm comm, int tag,
                                  const View<std::int64_t*>& words,
                                  const std::vector<MessageRange>& from) {
  if (from.empty())
    return;
  for (const MessageRange& range : from) {
    Peer& sender = _peers.at(range.rank);
    const Announcement& announcement = sender.announced;
    const std::int64_t number = announcement.slot;
    if (sender.generation[number] != announcement.generation) {
      sender.memory[number] = openMemory(announcement.memory, announcement.capacity);
      sender.generation[number] = announcement.generation;
    }
    if (sender.has_words[number] == nullptr)
      sender.has_words[number] = openEvent(announcement.event);
    check(sender.memory[number] != nullptr && sender.has_words[number] != nullptr,
          "opening the memory of a sender");
    check(announcement.words == range.end - range.begin, "agreeing on the size of a message");
    if (announcement.words == 0)
      continue;
    check(peer::waitFor(space, sender.has_words[number]), "waiting for a sender");
    check(peer::copy(space, words.data() + range.begin, sender.memory[number] + announcement.begin,
                     announcement.words),
          "copying");
  }
  check(peer::record(space, _shared->has_taken), "recording an event");
  waitAll(_confirms);
  _confirms.resize(from.size());
  for (std::size_t i = 0; i < from.size(); ++i)
    isend(_shared->confirmation, from[i].rank, tag + confirm, comm, _confirms[i]);
}

// The communicator may be freed next: all confirmations are awaited, which their senders have sent
// when their exchange ended. Where an exception unwinds, they may never come; the communicator then
// stays (mpi.hpp).
inline PeerMessages::~PeerMessages() {
  int is_finalized = 0;
  MPI_Finalized(&is_finalized);
  if (is_finalized != 0)
    return;
  if (std::uncaught_exceptions() > 0) {
    giveUp();
    return;
  }
  try {
    const exec_space space;
    for (Slot& slot : _shared->slots)
      awaitReaders(space, slot);
    waitAll(_confirms);
    space.fence();
    unused().push_back(std::move(_shared));
  } catch (const Error&) { // then it is not used again
  }
}

inline void PeerMessages::giveUp() {
  Slot(&slots)[2] = _shared->slots;
  for (auto* requests :
       {&slots[0].receives, &slots[1].receives, &slots[0].sends, &slots[1].sends, &_confirms}) {
    for (MPI_Request& request : *requests)
      MPI_Cancel(&request);
    MPI_Waitall(static_cast<int>(requests->size()), requests->data(), MPI_STATUSES_IGNORE);
  }
}

} // namespace brickwall
