// Sums of partial nodal values over the ranks that share a node: one message per partner, after
// which every sharer holds the same total (int64, so exactly).
#pragma once

#include "contact/base/messages/exchange_plan.hpp"
#include "contact/base/tags.hpp"
#include "mechanics/mesh/hex_mesh.hpp"

namespace brickwall::mechanics {

class SharedNodeSum {
public:
  SharedNodeSum() = default;
  // Collective; `comm` is copied. Throws InputError when `shared.ranks` and `shared.nodes` differ
  // in size.
  SharedNodeSum(const exec_space& space, MPI_Comm comm, const SharedNodeLists& shared) {
    if (shared.ranks.size() != shared.nodes.size())
      throw InputError("SharedNodeSum: " + std::to_string(shared.ranks.size()) + " ranks but " +
                       std::to_string(shared.nodes.size()) + " node lists");
    _plan = ExchangePlan(space, Communicator(comm), tags::shared_nodes, shared.ranks, shared.nodes,
                         shared.nodes);
  }

  // values(node, :) = sum of all sharers' values(node, :). View [node][W] of int64, with W equal on
  // all ranks. Collective among sharers.
  template <class Values>
  void sum(const exec_space& space, const Values& values) {
    _plan.sumShared(space, values);
  }

  const std::vector<int>& partners() const { return _plan.partners(); }

private:
  ExchangePlan _plan;
};

} // namespace brickwall::mechanics
