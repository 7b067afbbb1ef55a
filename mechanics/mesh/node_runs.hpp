// Nodes that a kernel works on: all nodes, or runs of consecutive ones.
#pragma once

#include "contact/base/backend.hpp"

#include <vector>

namespace brickwall::mechanics {

struct NodeRun {
  int first = 0, count = 0;
};

struct NodeSelection {
  static constexpr int nodes_per_run = 1024;

  bool all = true;
  int num_nodes = 0; // of the mesh
  View<const NodeRun*> runs; // used if not `all`; none is longer than nodes_per_run
  bool others_rest = false; // some nodes are omitted, and they are at rest

  static NodeSelection allOf(int num_nodes) {
    NodeSelection all_nodes;
    all_nodes.num_nodes = num_nodes;
    return all_nodes;
  }
  int numRuns() const {
    return all ? dividedUp(num_nodes, nodes_per_run) : static_cast<int>(runs.extent(0));
  }
  KOKKOS_INLINE_FUNCTION NodeRun run(int r) const {
    if (!all)
      return runs(r);
    return {r * nodes_per_run, minOf(+nodes_per_run, num_nodes - r * nodes_per_run)};
  }
};

// Appends a node whose number is larger than that of the last one.
inline void appendNode(int node, std::vector<NodeRun>& runs) {
  if (runs.empty() || runs.back().first + runs.back().count != node ||
      runs.back().count == NodeSelection::nodes_per_run)
    runs.push_back({node, 0});
  ++runs.back().count;
}

} // namespace brickwall::mechanics
