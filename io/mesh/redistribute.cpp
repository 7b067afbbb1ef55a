#include "io/mesh/redistribute.hpp"

#include "contact/base/mpi.hpp"
#include "io/mesh/local_numbering.hpp"
#include "io/mesh/shared_nodes.hpp"

#include <algorithm>
#include <array>

namespace brickwall::io {

namespace {

struct Elem {
  global_id id, number, body;
  std::int64_t block;
  global_id nodes[8];
};
struct Node {
  global_id id, number;
  double x[3];
};
// Number of the set, id of the element or node, side of the element: in the order of sets.
using SetEntry = std::array<std::int64_t, 3>;

// By id, without those that several ranks have sent.
template <class Entity>
void sortDistinct(std::vector<Entity>& entities) {
  std::sort(entities.begin(), entities.end(),
            [](const Entity& a, const Entity& b) { return a.id < b.id; });
  entities.erase(std::unique(entities.begin(), entities.end(),
                             [](const Entity& a, const Entity& b) { return a.id == b.id; }),
                 entities.end());
}

void moveElems(MPI_Comm comm, const MeshPart& part, const std::vector<int>& rank_of_elem,
               MeshPart& moved) {
  const std::vector<global_id> node_numbers = part.nodeNumbers(), elem_numbers = part.elemNumbers();
  std::vector<Elem> elems(part.elem_ids.size());
  std::vector<std::vector<int>> nodes_for(sizeOf(comm)); // local
  for (std::size_t e = 0; e < elems.size(); ++e) {
    elems[e] = {part.elem_ids[e], elem_numbers[e], part.elem_body[e], part.elem_block[e], {}};
    for (std::size_t c = 0; c < 8; ++c) {
      const int node = part.elem_nodes[8 * e + c];
      elems[e].nodes[c] = part.node_ids[node];
      nodes_for[rank_of_elem[e]].push_back(node);
    }
  }
  elems = sendTo(comm, rank_of_elem, elems);
  sortDistinct(elems);
  rethrowOnAllRanks(comm, [&] {
    checkedInt(8 * static_cast<std::int64_t>(elems.size()), "redistribute: element corners");
  });

  std::vector<std::vector<Node>> to_ranks(sizeOf(comm));
  for (std::size_t q = 0; q < nodes_for.size(); ++q) {
    std::sort(nodes_for[q].begin(), nodes_for[q].end());
    nodes_for[q].erase(std::unique(nodes_for[q].begin(), nodes_for[q].end()), nodes_for[q].end());
    for (const int node : nodes_for[q]) {
      const auto at = static_cast<std::size_t>(node);
      const double* x = &part.coordinates[3 * at];
      to_ranks[q].push_back({part.node_ids[at], node_numbers[at], {x[0], x[1], x[2]}});
    }
  }
  std::vector<Node> nodes = joined(exchangeByRank(comm, to_ranks));
  sortDistinct(nodes);
  for (const Node& node : nodes) {
    moved.node_ids.push_back(node.id);
    moved.node_numbers.push_back(node.number);
    moved.coordinates.insert(moved.coordinates.end(), node.x, node.x + 3);
  }
  for (const Elem& elem : elems) {
    moved.elem_ids.push_back(elem.id);
    moved.elem_numbers.push_back(elem.number);
    moved.elem_body.push_back(elem.body);
    moved.elem_block.push_back(static_cast<int>(elem.block));
    for (const global_id node : elem.nodes)
      moved.elem_nodes.push_back(localIndex(moved.node_ids, node));
  }
  moved.dropPlainNumbers();
}

// The entries that all ranks have sent here, once each.
std::vector<SetEntry> exchangeEntries(MPI_Comm comm,
                                      const std::vector<std::vector<SetEntry>>& to_ranks) {
  std::vector<SetEntry> entries = joined(exchangeByRank(comm, to_ranks));
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  return entries;
}

void moveSets(MPI_Comm comm, const MeshPart& part, const std::vector<int>& rank_of_elem,
              MeshPart& moved) {
  std::vector<std::vector<SetEntry>> sides(sizeOf(comm)), nodes(sizeOf(comm));
  for (std::size_t s = 0; s < part.side_sets.size(); ++s) {
    const SideSet& set = part.side_sets[s];
    moved.side_sets.push_back({set.id, set.name, {}, {}});
    for (std::size_t i = 0; i < set.elems.size(); ++i)
      sides[rank_of_elem[set.elems[i]]].push_back(
          {static_cast<std::int64_t>(s), part.elem_ids[set.elems[i]], set.sides[i]});
  }
  for (const auto& [s, elem, side] : exchangeEntries(comm, sides)) {
    moved.side_sets[s].elems.push_back(localIndex(moved.elem_ids, elem));
    moved.side_sets[s].sides.push_back(static_cast<int>(side));
  }

  std::vector<std::pair<int, int>> node_ranks; // local node, rank of one of its elements
  for (std::size_t i = 0; i < part.elem_nodes.size(); ++i)
    node_ranks.emplace_back(part.elem_nodes[i], rank_of_elem[i / 8]);
  std::sort(node_ranks.begin(), node_ranks.end());
  node_ranks.erase(std::unique(node_ranks.begin(), node_ranks.end()), node_ranks.end());
  for (std::size_t s = 0; s < part.node_sets.size(); ++s) {
    const NodeSet& set = part.node_sets[s];
    moved.node_sets.push_back({set.id, set.name, {}});
    for (const int node : set.nodes)
      for (auto at =
               std::lower_bound(node_ranks.begin(), node_ranks.end(), std::make_pair(node, 0));
           at != node_ranks.end() && at->first == node; ++at)
        nodes[at->second].push_back({static_cast<std::int64_t>(s), part.node_ids[node], 0});
  }
  for (const auto& [s, node, unused] : exchangeEntries(comm, nodes))
    moved.node_sets[s].nodes.push_back(localIndex(moved.node_ids, node));
}

} // namespace

MeshPart redistribute(MPI_Comm comm, const MeshPart& part, const std::vector<int>& rank_of_elem) {
  MeshPart moved;
  moved.blocks = part.blocks;
  moved.empty_blocks = part.empty_blocks;
  moved.num_global_nodes = part.num_global_nodes;
  moved.num_global_elems = part.num_global_elems;
  moved.num_global_bodies = part.num_global_bodies;
  moveElems(comm, part, rank_of_elem, moved);
  moveSets(comm, part, rank_of_elem, moved);
  NodeSharing sharing = findSharedNodes(comm, moved.node_ids, moved.num_global_nodes);
  moved.node_owner = std::move(sharing.node_owner);
  moved.shared_nodes = std::move(sharing.sharers);
  return moved;
}

} // namespace brickwall::io
