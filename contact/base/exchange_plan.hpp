// Pairwise messages over a fixed pattern: the plan is built once and applied to many Views. One
// message per partner and direction; buffers persist; one fence, receives are posted, sends, one
// wait.
#pragma once

#include "contact/base/backend.hpp"
#include "contact/base/mpi.hpp"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace brickwall {

// Messages of 64-bit words that are under way.
class WordMessages {
public:
  void send(const std::int64_t* data, std::int64_t words, int receiver, int tag, MPI_Comm comm) {
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
  // A message that was probed, of known size.
  void receive(std::int64_t* data, std::int64_t words, MPI_Message& message) {
    _requests.emplace_back();
    checkMpi(MPI_Imrecv(data, static_cast<int>(words), MPI_INT64_T, &message, &_requests.back()),
             "MPI_Imrecv");
  }
  void wait() {
    const Region region(waiting_region);
    checkMpi(MPI_Waitall(static_cast<int>(_requests.size()), _requests.data(), MPI_STATUSES_IGNORE),
             "MPI_Waitall");
    _requests.clear();
  }

private:
  std::vector<MPI_Request> _requests;
};

// Persistent message buffers between this rank and some partners, in 64-bit words. The device reads
// and writes `send` and `receive`; staging copies stand between them and MPI where MPI cannot read
// device memory.
class MessageBuffers {
public:
  // Words sent to and received from each partner, whose ranks are `partners`; offsets have partners
  // + 1 entries. Collective among partners: each must call it with matching sizes.
  void exchange(const exec_space& space, MPI_Comm comm, int tag, const std::vector<int>& partners,
                const std::vector<std::int64_t>& send_offsets,
                const std::vector<std::int64_t>& receive_offsets) {
    if (partners.empty()) // nor a wait for the device
      return;
    const std::int64_t num_send = send_offsets.back(), num_receive = receive_offsets.back();
    growTo(space, receive, num_receive);
    growStaging(num_send, num_receive);
    if constexpr (!host_accessible)
      copyRange(space, _staged_send, send, num_send);
    // Also before the receives: the device may still be reading the data of the last exchange.
    space.fence();
    const int rank = rankOf(comm); // it may be among the partners
    for (std::size_t p = 0; p < partners.size(); ++p)
      if (const std::int64_t words = receive_offsets[p + 1] - receive_offsets[p];
          words > 0 && partners[p] != rank)
        _messages.receive(receiveData() + receive_offsets[p], words, partners[p], tag, comm);
    for (std::size_t p = 0; p < partners.size(); ++p)
      if (const std::int64_t words = send_offsets[p + 1] - send_offsets[p];
          words > 0 && partners[p] != rank)
        _messages.send(sendData() + send_offsets[p], words, partners[p], tag, comm);
    for (std::size_t p = 0; p < partners.size(); ++p)
      if (partners[p] == rank)
        std::copy(sendData() + send_offsets[p], sendData() + send_offsets[p + 1],
                  receiveData() + receive_offsets[p]);
    _messages.wait();
    if constexpr (!host_accessible)
      copyRange(space, receive, _staged_receive, num_receive);
  }

  // The same with sizes that the receivers do not know. Sends a message, possibly empty, to each of
  // `receivers`; `receive_offsets` [sender + 1] are set from the sizes of the messages of
  // `senders`.
  void exchangeOfAnySize(const exec_space& space, MPI_Comm comm, int tag,
                         const std::vector<int>& receivers,
                         const std::vector<std::int64_t>& send_offsets,
                         const std::vector<int>& senders,
                         std::vector<std::int64_t>& receive_offsets) {
    receive_offsets.assign(1, 0);
    if (receivers.empty() && senders.empty())
      return;
    growStaging(send_offsets.back(), 0);
    if constexpr (!host_accessible)
      copyRange(space, _staged_send, send, send_offsets.back());
    space.fence(); // `receive` may still be read as well
    for (std::size_t p = 0; p < receivers.size(); ++p)
      _messages.send(sendData() + send_offsets[p], send_offsets[p + 1] - send_offsets[p],
                     receivers[p], tag, comm);
    // All sizes first, so that the buffer grows before it receives data.
    probe(comm, tag, senders, receive_offsets);
    const std::int64_t num_receive = receive_offsets.back();
    growTo(space, receive, num_receive);
    growStaging(0, num_receive);
    space.fence(); // the old View is freed before MPI writes
    for (std::size_t p = 0; p < senders.size(); ++p)
      _messages.receive(receiveData() + receive_offsets[p],
                        receive_offsets[p + 1] - receive_offsets[p], _probed[p]);
    _messages.wait();
    if constexpr (!host_accessible)
      copyRange(space, receive, _staged_receive, num_receive);
  }

  View<std::int64_t*> send{"base::MessageBuffers::send", 0};
  View<std::int64_t*> receive{"base::MessageBuffers::receive", 0};

private:
  using staging_view = Kokkos::View<std::int64_t*, staging_space>;

  void probe(MPI_Comm comm, int tag, const std::vector<int>& senders,
             std::vector<std::int64_t>& receive_offsets) {
    const Region region(waiting_region);
    _probed.resize(senders.size());
    for (std::size_t p = 0; p < senders.size(); ++p) {
      MPI_Status status;
      int words = 0;
      checkMpi(MPI_Mprobe(senders[p], tag, comm, &_probed[p], &status), "MPI_Mprobe");
      checkMpi(MPI_Get_count(&status, MPI_INT64_T, &words), "MPI_Get_count");
      receive_offsets.push_back(receive_offsets.back() + words);
    }
  }

  template <class To, class From>
  static void copyRange(const exec_space& space, const To& to, const From& from, std::int64_t n) {
    const auto range = std::make_pair(std::size_t(0), static_cast<std::size_t>(n));
    if (n > 0)
      Kokkos::deep_copy(space, Kokkos::subview(to, range), Kokkos::subview(from, range));
  }
  void growStaging(std::int64_t num_send, std::int64_t num_receive) {
    if constexpr (!host_accessible) {
      if (static_cast<std::int64_t>(_staged_send.extent(0)) < num_send)
        _staged_send = staging_view("base::MessageBuffers::staged_send", num_send + num_send / 4);
      if (static_cast<std::int64_t>(_staged_receive.extent(0)) < num_receive)
        _staged_receive =
            staging_view("base::MessageBuffers::staged_receive", num_receive + num_receive / 4);
    } else {
      (void)num_send, (void)num_receive;
    }
  }
  std::int64_t* sendData() { return host_accessible ? send.data() : _staged_send.data(); }
  std::int64_t* receiveData() { return host_accessible ? receive.data() : _staged_receive.data(); }
  staging_view _staged_send, _staged_receive;
  WordMessages _messages;
  std::vector<MPI_Message> _probed;
};

// Bits of a double as a message word and back.
KOKKOS_INLINE_FUNCTION std::int64_t toWord(double value) {
  std::int64_t word;
  memcpy(&word, &value, sizeof word);
  return word;
}
KOKKOS_INLINE_FUNCTION std::int64_t toWord(std::int64_t value) {
  return value;
}
KOKKOS_INLINE_FUNCTION void fromWord(std::int64_t word, double& value) {
  memcpy(&value, &word, sizeof word);
}
KOKKOS_INLINE_FUNCTION void fromWord(std::int64_t word, std::int64_t& value) {
  value = word;
}

// How a received value is placed. Several partners may add to one row.
struct AssignReceived {
  template <class T>
  KOKKOS_INLINE_FUNCTION static void place(T& target, T value) {
    target = value;
  }
};
struct AddReceived {
  template <class T>
  KOKKOS_INLINE_FUNCTION static void place(T& target, T value) {
    Kokkos::atomic_add(&target, value);
  }
};

template <class SourceView>
struct PackRow {
  SourceView source;
  View<int*> rows;
  View<std::int64_t*> packed;
  std::int64_t width;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t i) const {
    for (std::int64_t w = 0; w < width; ++w)
      packed(i * width + w) = toWord(source(rows(i), w));
  }
};
template <class Place, class TargetView>
struct UnpackRow {
  View<std::int64_t*> packed;
  View<int*> rows;
  TargetView target;
  std::int64_t width;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t i) const {
    for (std::int64_t w = 0; w < width; ++w) {
      typename TargetView::non_const_value_type value;
      fromWord(packed(i * width + w), value);
      Place::place(target(rows(i), w), value);
    }
  }
};

// packed(i * width + w) = source(rows(i), w) for i in [0, num_rows).
template <class SourceView>
void packRows(const exec_space& space, const SourceView& source, const View<int*>& rows,
              std::int64_t num_rows, const View<std::int64_t*>& packed) {
  const auto width = static_cast<std::int64_t>(source.extent(1));
  Kokkos::parallel_for("base::ExchangePlan::pack", rangePolicy(space, num_rows),
                       PackRow<SourceView>{source, rows, packed, width});
}
// Places packed(i * width + w) at target(rows(i), w) for i in [0, num_rows).
template <class Place, class TargetView>
void unpackRows(const exec_space& space, const View<std::int64_t*>& packed, const View<int*>& rows,
                std::int64_t num_rows, const TargetView& target) {
  const auto width = static_cast<std::int64_t>(target.extent(1));
  Kokkos::parallel_for("base::ExchangePlan::unpack", rangePolicy(space, num_rows),
                       UnpackRow<Place, TargetView>{packed, rows, target, width});
}

// Rows of local arrays that go to and come from each partner. Row lists of partner p are
// [offsets[p], offsets[p+1]); both sides must list matching rows in the same order.
class ExchangePlan {
public:
  ExchangePlan() = default;
  // Host lists: `send_rows[p]` and `receive_rows[p]` for partner rank `partners[p]`. Tag must not
  // be used by another plan that is in flight at the same time.
  ExchangePlan(const exec_space& space, const Communicator& comm, int tag,
               std::vector<int> partners, const std::vector<std::vector<int>>& send_rows,
               const std::vector<std::vector<int>>& receive_rows)
      : _comm(comm), _tag(tag), _partners(std::move(partners)), _send_offsets(offsetsOf(send_rows)),
        _receive_offsets(offsetsOf(receive_rows)),
        _send_rows(flatten(space, "base::ExchangePlan::send_rows", send_rows)),
        _receive_rows(flatten(space, "base::ExchangePlan::receive_rows", receive_rows)) {}

  const std::vector<int>& partners() const { return _partners; }
  std::int64_t numSendRows() const { return _send_offsets.back(); }
  std::int64_t numReceiveRows() const { return _receive_offsets.back(); }

  // Owner to ghost: values(receive_row, :) = the partner's values(send_row, :). View [row][W] of
  // double or int64, W equal on all ranks. Collective among partners.
  template <class ViewType>
  void forward(const exec_space& space, const ViewType& values) {
    forward(space, values, values);
  }
  // Owner to ghost between two arrays: target(receive_row, :) = the partner's source(send_row, :).
  template <class SourceView, class TargetView>
  void forward(const exec_space& space, const SourceView& source, const TargetView& target) {
    transfer(space, source, target, _send_rows, _send_offsets, _receive_rows, _receive_offsets,
             AssignReceived());
  }
  // Ghost to owner: values(send_row, :) += the partner's values(receive_row, :). int64 only: exact
  // in any order.
  template <class ViewType>
  void reverseSum(const exec_space& space, const ViewType& values) {
    static_assert(std::is_same_v<typename ViewType::non_const_value_type, std::int64_t>);
    transfer(space, values, values, _receive_rows, _receive_offsets, _send_rows, _send_offsets,
             AddReceived());
  }
  // Adds every partner's partial sums to this rank's, where both list the same rows to send and to
  // receive: afterwards all copies hold the same total. int64 only.
  template <class ViewType>
  void sumShared(const exec_space& space, const ViewType& values) {
    static_assert(std::is_same_v<typename ViewType::non_const_value_type, std::int64_t>);
    transfer(space, values, values, _send_rows, _send_offsets, _receive_rows, _receive_offsets,
             AddReceived());
  }

private:
  template <class SourceView, class TargetView, class Place>
  void transfer(const exec_space& space, const SourceView& source, const TargetView& target,
                const View<int*>& from_rows, const std::vector<std::int64_t>& from_offsets,
                const View<int*>& to_rows, const std::vector<std::int64_t>& to_offsets, Place) {
    if (_partners.empty())
      return;
    const auto width = static_cast<std::int64_t>(source.extent(1));
    const std::int64_t num_from = from_offsets.back(), num_to = to_offsets.back();
    growTo(space, _buffers.send, num_from * width);
    packRows(space, source, from_rows, num_from, _buffers.send);
    _buffers.exchange(space, _comm, _tag, _partners, scaled(from_offsets, width, _send_words),
                      scaled(to_offsets, width, _receive_words));
    unpackRows<Place>(space, _buffers.receive, to_rows, num_to, target);
  }

  static std::vector<std::int64_t> offsetsOf(const std::vector<std::vector<int>>& rows) {
    std::vector<std::int64_t> offsets(1, 0);
    for (const auto& list : rows)
      offsets.push_back(offsets.back() + static_cast<std::int64_t>(list.size()));
    return offsets;
  }
  static View<int*> flatten(const exec_space& space, const std::string& label,
                            const std::vector<std::vector<int>>& rows) {
    const auto offsets = offsetsOf(rows);
    auto flat = allocate<View<int*>>(space, label, offsets.back());
    auto host = Kokkos::create_mirror_view(flat);
    std::size_t next = 0;
    for (const auto& list : rows)
      for (const int row : list)
        host(next++) = row;
    Kokkos::deep_copy(space, flat, host);
    space.fence();
    return flat;
  }
  static const std::vector<std::int64_t>& scaled(const std::vector<std::int64_t>& offsets,
                                                 std::int64_t width,
                                                 std::vector<std::int64_t>& words) {
    words.resize(offsets.size());
    for (std::size_t p = 0; p < offsets.size(); ++p)
      words[p] = offsets[p] * width;
    return words;
  }

  Communicator _comm;
  int _tag = 0;
  std::vector<int> _partners;
  std::vector<std::int64_t> _send_offsets{0}, _receive_offsets{0};
  View<int*> _send_rows, _receive_rows;
  MessageBuffers _buffers;
  std::vector<std::int64_t> _send_words, _receive_words;
};

} // namespace brickwall
