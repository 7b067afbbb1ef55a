// Finds the nodes that this rank shares with each other rank, by rendezvous: each node id has a
// home rank where its sharers meet. The cost is proportional to the number of local nodes.
#pragma once

#include "io/mesh/mesh_part.hpp"

#include <mpi.h>

#include <vector>

namespace brickwall::io {

struct NodeSharing {
  std::vector<int> node_owner; // [node] lowest rank that has the node
  std::vector<SharedNodes> sharers; // in the order of rank
};

// `node_ids` ascend and are below `num_global_nodes`. Collective.
NodeSharing findSharedNodes(MPI_Comm comm, const std::vector<global_id>& node_ids,
                            global_id num_global_nodes);

} // namespace brickwall::io
