// The bodies of the clusters of nodes and of the blocks of faces of an order.
#pragma once

#include "contact/search/cluster/cluster_order.hpp"

namespace brickwall::contact {

// Sets cluster_body and block_body of an order whose other members are set. Fences.
void nameBodies(const exec_space& space, const SweptBoxes& surface, ClusterOrder& order);

} // namespace brickwall::contact
