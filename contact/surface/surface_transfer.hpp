// Nodal values of one decomposition of a surface at the nodes of another: of all nodes, or of those
// that are selected in a step.
#pragma once

#include "contact/base/messages/exchange_plan.hpp"

#include <cstdint>
#include <utility>
#include <vector>

namespace brickwall::contact {

class SurfaceTransfer {
public:
  template <class SourceView, class TargetView>
  struct CopyRow {
    SourceView source;
    TargetView target;
    View<int*> from, to;
    int width;

    KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t i) const {
      for (int w = 0; w < width; ++w)
        target(to(i), w) = source(from(i), w);
    }
  };
  using Flags = View<unsigned char*>; // [row]

  SurfaceTransfer() = default;
  // Of this rank: the rows that go to each rank and that come from each, [rank]. Collective.
  SurfaceTransfer(const exec_space& space, const Communicator& comm,
                  std::vector<std::vector<int>> from_rows, std::vector<std::vector<int>> to_rows);

  template <class SourceView, class TargetView>
  void forward(const exec_space& space, const SourceView& source, const TargetView& target) {
    copyRows(space, source, target, _from, _to, static_cast<std::int64_t>(_from.extent(0)));
    _plan.forward(space, source, target);
  }
  // Where both lists are the same, without rows of this rank itself (ExchangePlan::sumShared()).
  template <class ViewType>
  void sumShared(const exec_space& space, const ViewType& values) {
    _plan.sumShared(space, values);
  }

  // As forward(), in messages of a bit for each row, but flags of the target that are set stay so.
  void forwardFlags(const exec_space& space, const Flags& source, const Flags& target);
  // forwardSelected() then transfers the rows whose flags are set: those of a row that is sent and
  // of where it is received must be equal.
  void select(const exec_space& space, const Flags& source, const Flags& target);
  template <class SourceView, class TargetView>
  void forwardSelected(const exec_space& space, const SourceView& source,
                       const TargetView& target) {
    copyRows(space, source, target, _selected_from, _selected_to, _num_selected);
    exchangeSelected<AssignReceived>(space, source, target);
  }
  // sumShared() for the rows whose flags are set on any rank. Afterwards they are set on all.
  void selectShared(const exec_space& space, const Flags& flags) {
    forwardFlags(space, flags, flags);
    select(space, flags, flags);
  }
  template <class ViewType>
  void sumSelected(const exec_space& space, const ViewType& values) {
    exchangeSelected<AddReceived>(space, values, values);
  }
  // The rows that go to other ranks; some repeat.
  View<const int*> rows() const { return _sent.rows; }
  // Those that are selected.
  View<const int*> selectedRows() const {
    return Kokkos::subview(_sent.selected,
                           std::make_pair(std::int64_t(0), _sent.selected_ends.back()));
  }

private:
  // The rows that go to all partners, one after another, or come from them.
  struct Side {
    View<int*> rows;
    std::vector<std::int64_t> ends; // 0, and the end of the rows of each partner
    View<int*> word_begin; // [word of flags] its first row, and the end
    std::vector<std::int64_t> word_ends; // of the words, as `ends`
    View<int*> place; // [row] selected rows before it, and the end
    View<int*>::HostMirror host_place;
    View<int*> selected;
    std::vector<std::int64_t> selected_ends{0}; // as `ends`
    std::vector<std::int64_t> selected_word_ends; // in words of a message

    Side() = default;
    Side(const exec_space& space, const std::vector<std::vector<int>>& of_partners);
    void select(const exec_space& space, const Flags& flags);
  };

  template <class SourceView, class TargetView>
  static void copyRows(const exec_space& space, const SourceView& source, const TargetView& target,
                       const View<int*>& from, const View<int*>& to, std::int64_t num_rows) {
    Kokkos::parallel_for("contact::SurfaceTransfer::copyRows", rangePolicy(space, num_rows),
                         CopyRow<SourceView, TargetView>{source, target, from, to,
                                                         static_cast<int>(source.extent(1))});
  }

  template <class Place, class SourceView, class TargetView>
  void exchangeSelected(const exec_space& space, const SourceView& source,
                        const TargetView& target) {
    if (_plan.partners().empty())
      return;
    const auto width = static_cast<std::int64_t>(source.extent(1));
    growTo(space, _buffers.send, _sent.selected_ends.back() * width);
    packRows(space, source, _sent.selected, _sent.selected_ends.back(), _buffers.send);
    _buffers.exchange(space, _comm, _tag, _plan.partners(),
                      wordOffsets(_sent.selected_ends, width, _sent.selected_word_ends),
                      wordOffsets(_received.selected_ends, width, _received.selected_word_ends));
    unpackRows<Place>(space, _buffers.receive, _received.selected, _received.selected_ends.back(),
                      target);
  }

  View<int*> _from, _to; // rows that stay on this rank
  View<int*> _selected_from, _selected_to;
  int _num_selected = 0; // of these
  Communicator _comm;
  int _tag = 0;
  ExchangePlan _plan;
  Side _sent, _received;
  MessageBuffers _buffers; // of selected rows and flags
};

} // namespace brickwall::contact
