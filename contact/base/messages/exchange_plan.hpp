// Pairwise messages over a fixed pattern: the plan is built once and applied to many Views.
#pragma once

#include "contact/base/messages/message_buffers.hpp"

#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace brickwall {

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

// Offsets of messages in words, from those in rows of `width` words. Fills and returns `words`.
inline const std::vector<std::int64_t>& wordOffsets(const std::vector<std::int64_t>& offsets,
                                                    std::int64_t width,
                                                    std::vector<std::int64_t>& words) {
  words.resize(offsets.size());
  for (std::size_t p = 0; p < offsets.size(); ++p)
    words[p] = offsets[p] * width;
  return words;
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
    startSum(space, values);
    finishSum(space, values);
  }
  // The same in two parts, between which kernels run while the messages travel. They must not touch
  // the rows of the plan.
  template <class ViewType>
  void startSum(const exec_space& space, const ViewType& values) {
    static_assert(std::is_same_v<typename ViewType::non_const_value_type, std::int64_t>);
    start(space, values, _send_rows, _send_offsets, _receive_offsets);
  }
  template <class ViewType>
  void finishSum(const exec_space& space, const ViewType& values) {
    finish<AddReceived>(space, values, _receive_rows, _receive_offsets);
  }

private:
  template <class SourceView, class TargetView, class Place>
  void transfer(const exec_space& space, const SourceView& source, const TargetView& target,
                const View<int*>& from_rows, const std::vector<std::int64_t>& from_offsets,
                const View<int*>& to_rows, const std::vector<std::int64_t>& to_offsets, Place) {
    start(space, source, from_rows, from_offsets, to_offsets);
    finish<Place>(space, target, to_rows, to_offsets);
  }
  template <class SourceView>
  void start(const exec_space& space, const SourceView& source, const View<int*>& from_rows,
             const std::vector<std::int64_t>& from_offsets,
             const std::vector<std::int64_t>& to_offsets) {
    if (_partners.empty())
      return;
    const auto width = static_cast<std::int64_t>(source.extent(1));
    growTo(space, _buffers.send, from_offsets.back() * width);
    packRows(space, source, from_rows, from_offsets.back(), _buffers.send);
    _buffers.start(space, _comm, _tag, _partners, wordOffsets(from_offsets, width, _send_words),
                   wordOffsets(to_offsets, width, _receive_words));
  }
  template <class Place, class TargetView>
  void finish(const exec_space& space, const TargetView& target, const View<int*>& to_rows,
              const std::vector<std::int64_t>& to_offsets) {
    if (_partners.empty())
      return;
    _buffers.finish(space);
    unpackRows<Place>(space, _buffers.receive, to_rows, to_offsets.back(), target);
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

  Communicator _comm;
  int _tag = 0;
  std::vector<int> _partners;
  std::vector<std::int64_t> _send_offsets{0}, _receive_offsets{0};
  View<int*> _send_rows, _receive_rows;
  MessageBuffers _buffers;
  std::vector<std::int64_t> _send_words, _receive_words;
};

} // namespace brickwall
