// Sums of partial nodal values over the ranks that share a node: one message per partner, after
// which every sharer holds the same total (int64, so exactly).
#pragma once

#include "contact/base/messages/exchange_plan.hpp"
#include "contact/base/tags.hpp"
#include "mechanics/mesh/hex_mesh.hpp"
#include "mechanics/mesh/nodal_state.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace brickwall::mechanics {

// The columns of the kinds of force that act, side by side, as ExchangePlan takes values.
struct ActingForces {
  using non_const_value_type = std::int64_t;

  explicit ActingForces(const NodalForces& forces) : values(forces.values) {
    const int kinds = static_cast<int>(values.extent(1)) / 3;
    for (int kind = 0; kind < kinds; ++kind)
      if (forces.acts[kind])
        kind_of[num_kinds++] = kind;
  }
  ActingForces() = default;
  KOKKOS_INLINE_FUNCTION std::size_t extent(int dimension) const {
    return dimension == 0 ? values.extent(0) : 3 * static_cast<std::size_t>(num_kinds);
  }
  KOKKOS_INLINE_FUNCTION std::int64_t& operator()(std::int64_t node, std::int64_t column) const {
    return values(node, 3 * kind_of[column / 3] + column % 3);
  }

  ForceColumns values;
  int kind_of[num_force_kinds] = {};
  int num_kinds = 0;
};

class SharedNodeSum {
public:
  SharedNodeSum() = default;
  // Collective; `comm` is copied. Throws InputError when `shared.ranks` and `shared.nodes` differ
  // in size.
  SharedNodeSum(const exec_space& space, MPI_Comm comm, const SharedNodeLists& shared) {
    if (shared.ranks.size() != shared.nodes.size())
      throw InputError("SharedNodeSum: found " + std::to_string(shared.nodes.size()) +
                       " lists of nodes, expected one for each of " +
                       std::to_string(shared.ranks.size()) + " ranks");
    _plan = ExchangePlan(space, Communicator(comm), tags::shared_nodes, shared.ranks, shared.nodes,
                         shared.nodes);
  }

  // values(node, :) = sum of all sharers' values(node, :). View [node][W] of int64, with W equal on
  // all ranks. Collective among sharers.
  template <class Values>
  void sum(const exec_space& space, const Values& values) {
    finish(space);
    _plan.sumShared(space, values);
  }

  // The same for the forces that act, in two parts: kernels that are launched between them run
  // while the messages travel, and must not use these forces. finish() does nothing if none is
  // under way. The forces are complete at `are_complete`, which must outlive the sum: without
  // partners, kernels wait for it from finish() on.
  void start(const exec_space& space, const NodalForces& forces, const QueueMark& are_complete) {
    finish(space);
    _forces = ActingForces(forces);
    _are_complete = &are_complete;
    if (!partners().empty())
      are_complete.waitIn(space);
    _is_under_way = true;
    _plan.startSum(space, _forces);
  }
  void finish(const exec_space& space) {
    if (_is_under_way) {
      if (partners().empty())
        _are_complete->waitIn(space);
      _plan.finishSum(space, _forces);
    }
    _is_under_way = false;
  }

  const std::vector<int>& partners() const { return _plan.partners(); }

private:
  ExchangePlan _plan;
  ActingForces _forces; // under way
  const QueueMark* _are_complete = nullptr;
  bool _is_under_way = false;
};

} // namespace brickwall::mechanics
