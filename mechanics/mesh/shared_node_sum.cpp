#include "mechanics/mesh/shared_node_sum.hpp"

#include "contact/base/tags.hpp"

namespace brickwall::mechanics {

SharedNodeSum::SharedNodeSum(const exec_space& space, MPI_Comm comm,
                             const SharedNodeLists& shared) {
  if (shared.ranks.size() != shared.nodes.size())
    throw InputError("SharedNodeSum: " + std::to_string(shared.ranks.size()) + " ranks but " +
                     std::to_string(shared.nodes.size()) + " node lists");
  _plan = ExchangePlan(space, Communicator(comm), tags::shared_nodes, shared.ranks, shared.nodes,
                       shared.nodes);
}

} // namespace brickwall::mechanics
