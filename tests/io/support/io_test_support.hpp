// Helpers of the io tests: a folder for files, and a mesh gathered from all ranks so that it can be
// compared.
#pragma once

#include "contact/base/mpi.hpp"
#include "io/mesh/mesh_part.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace brickwall::io::testing {

using brickwall::testing::TemporaryFolder;

template <class T>
std::vector<std::vector<T>> gatherToAll(MPI_Comm comm, const std::vector<T>& mine) {
  return exchangeByRank(comm, std::vector<std::vector<T>>(sizeOf(comm), mine));
}

struct Elem {
  global_id block, body;
  std::array<global_id, 8> nodes;
  bool operator==(const Elem& b) const {
    return block == b.block && body == b.body && nodes == b.nodes;
  }
};

// A mesh independent of how it is cut.
struct WholeMesh {
  std::map<global_id, Elem> elems;
  std::map<global_id, std::array<double, 3>> nodes;
  std::vector<std::pair<std::string, global_id>> blocks; // name, elements
  std::map<std::string, std::set<std::pair<global_id, int>>> side_sets; // name: element, side
  std::map<std::string, std::set<global_id>> node_sets;
  global_id num_bodies = 0;
  bool operator==(const WholeMesh& b) const {
    return elems == b.elems && nodes == b.nodes && blocks == b.blocks && side_sets == b.side_sets &&
           node_sets == b.node_sets && num_bodies == b.num_bodies;
  }
};

// Collective. Joins the parts and checks on the way that they fit together: no element twice, the
// same bits of a node on all its ranks.
inline WholeMesh gatherMesh(MPI_Comm comm, const MeshPart& part) {
  struct ElemMessage {
    global_id id, block, body, nodes[8];
  };
  struct NodeMessage {
    global_id id;
    double x[3];
  };
  struct SetMessage {
    std::int64_t set, entry, side;
  };
  std::vector<ElemMessage> elems;
  for (int e = 0; e < part.numElems(); ++e) {
    ElemMessage m{part.elem_ids[e], part.elem_block[e], part.elem_body[e], {}};
    for (int c = 0; c < 8; ++c)
      m.nodes[c] = part.node_ids[part.elem_nodes[8 * e + c]];
    elems.push_back(m);
  }
  std::vector<NodeMessage> nodes;
  for (int n = 0; n < part.numNodes(); ++n)
    nodes.push_back(
        {part.node_ids[n],
         {part.coordinates[3 * n], part.coordinates[3 * n + 1], part.coordinates[3 * n + 2]}});
  std::vector<SetMessage> sides, set_nodes;
  for (std::size_t s = 0; s < part.side_sets.size(); ++s)
    for (std::size_t i = 0; i < part.side_sets[s].elems.size(); ++i)
      sides.push_back({static_cast<std::int64_t>(s), part.elem_ids[part.side_sets[s].elems[i]],
                       part.side_sets[s].sides[i]});
  for (std::size_t s = 0; s < part.node_sets.size(); ++s)
    for (const int node : part.node_sets[s].nodes)
      set_nodes.push_back({static_cast<std::int64_t>(s), part.node_ids[node], 0});

  WholeMesh mesh;
  for (const auto& from : gatherToAll(comm, elems))
    for (const auto& m : from) {
      Elem elem{m.block, m.body, {}};
      std::copy(m.nodes, m.nodes + 8, elem.nodes.begin());
      EXPECT_TRUE(mesh.elems.emplace(m.id, elem).second) << "element " << m.id << " twice";
    }
  for (const auto& from : gatherToAll(comm, nodes))
    for (const auto& m : from) {
      const std::array<double, 3> x = {m.x[0], m.x[1], m.x[2]};
      EXPECT_EQ(mesh.nodes.emplace(m.id, x).first->second, x);
    }
  for (const Block& block : part.blocks)
    mesh.blocks.emplace_back(block.name, block.num_global_elems);
  for (const SideSet& set : part.side_sets)
    mesh.side_sets[set.name];
  for (const NodeSet& set : part.node_sets)
    mesh.node_sets[set.name];
  for (const auto& from : gatherToAll(comm, sides))
    for (const auto& m : from)
      mesh.side_sets[part.side_sets[m.set].name].emplace(m.entry, static_cast<int>(m.side));
  for (const auto& from : gatherToAll(comm, set_nodes))
    for (const auto& m : from)
      mesh.node_sets[part.node_sets[m.set].name].insert(m.entry);
  mesh.num_bodies = part.num_global_bodies;
  return mesh;
}

// Collective. Lists ascend, numbers are complete, shared lists are symmetric and complete, owners
// are the lowest sharers, a shared node is in a set on all its ranks or on none.
inline void expectConsistent(MPI_Comm comm, const MeshPart& part) {
  EXPECT_TRUE(std::is_sorted(part.node_ids.begin(), part.node_ids.end()));
  EXPECT_TRUE(std::is_sorted(part.elem_ids.begin(), part.elem_ids.end()));
  const auto ids_of_rank = gatherToAll(comm, part.node_ids);
  std::map<global_id, std::vector<int>> ranks_of_node;
  for (int q = 0; q < sizeOf(comm); ++q)
    for (const global_id id : ids_of_rank[q])
      ranks_of_node[id].push_back(q);
  EXPECT_EQ(static_cast<global_id>(ranks_of_node.size()), part.num_global_nodes);
  EXPECT_EQ(allReduce<std::int64_t>(comm, part.numElems(), MPI_SUM), part.num_global_elems);

  const int rank = rankOf(comm);
  std::map<int, std::vector<int>> shared;
  for (int node = 0; node < part.numNodes(); ++node) {
    const auto& ranks = ranks_of_node[part.node_ids[node]];
    EXPECT_EQ(part.node_owner[node], ranks.front());
    for (const int q : ranks)
      if (q != rank)
        shared[q].push_back(node);
  }
  ASSERT_EQ(shared.size(), part.shared_nodes.size());
  std::size_t next = 0;
  for (const auto& [q, nodes] : shared) {
    EXPECT_EQ(part.shared_nodes[next].rank, q);
    EXPECT_EQ(part.shared_nodes[next].nodes, nodes);
    ++next;
  }
  const WholeMesh mesh = gatherMesh(comm, part);
  for (const NodeSet& set : part.node_sets) {
    std::vector<int> expected;
    for (int node = 0; node < part.numNodes(); ++node)
      if (mesh.node_sets.at(set.name).count(part.node_ids[node]) > 0)
        expected.push_back(node);
    EXPECT_EQ(set.nodes, expected);
  }
  for (const SideSet& set : part.side_sets) {
    std::vector<std::pair<int, int>> entries;
    for (std::size_t i = 0; i < set.elems.size(); ++i)
      entries.emplace_back(set.elems[i], set.sides[i]);
    EXPECT_TRUE(std::is_sorted(entries.begin(), entries.end()));
  }
}

// What `work` throws, and that it throws at all.
template <class Work>
std::pair<ExitCode, std::string> errorOf(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    return {error.code(), error.what()};
  }
  return {ExitCode::success, "nothing was thrown"};
}

} // namespace brickwall::io::testing
