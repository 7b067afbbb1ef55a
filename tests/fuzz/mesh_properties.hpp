// What holds for every mesh that the reader accepts.
#pragma once

#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/session.hpp"

#include "contact/base/error.hpp"
#include "io/exodus/mesh_reader.hpp"
#include "io/exodus/mesh_writer.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <vector>

namespace brickwall::fuzz {

// Nothing if the file is refused with a message.
inline std::optional<io::MeshPart> readOrRefuse(const std::string& path) {
  try {
    return io::readMesh(MPI_COMM_SELF, path);
  } catch (const InputError& error) {
    demand(*error.what() != 0, "a refused file is explained");
    return {};
  }
}

inline void demandSound(const io::MeshPart& part) {
  const auto isBelow = [](const auto& list, std::int64_t limit) {
    return std::all_of(list.begin(), list.end(), [&](auto i) { return i >= 0 && i < limit; });
  };
  const int nodes = part.numNodes(), elems = part.numElems();
  demand(part.num_global_nodes == nodes && part.num_global_elems == elems && elems > 0, "counts");
  for (int i = 0; i < nodes; ++i)
    demand(part.node_ids[i] == i, "nodes are numbered");
  for (int i = 0; i < elems; ++i)
    demand(part.elem_ids[i] == i, "elements are numbered");
  demand(part.coordinates.size() == 3 * part.node_ids.size(), "coordinates");
  for (const double x : part.coordinates)
    demand(std::isfinite(x), "coordinates are finite");
  demand(part.elem_nodes.size() == 8 * part.elem_ids.size(), "corners");
  demand(isBelow(part.elem_nodes, nodes), "corners are nodes");
  demand(std::set<int>(part.elem_nodes.begin(), part.elem_nodes.end()).size() ==
             part.node_ids.size(),
         "every node is used");
  std::vector<std::int64_t> of_block(part.blocks.size());
  for (const int block : part.elem_block) {
    demand(block >= 0 && block < static_cast<int>(part.blocks.size()), "blocks of elements");
    ++of_block[block];
  }
  for (std::size_t b = 0; b < part.blocks.size(); ++b)
    demand(of_block[b] == part.blocks[b].num_global_elems, "elements of blocks");
  std::vector<std::int64_t> body_of_node(part.node_ids.size(), -1);
  for (std::size_t i = 0; i < part.elem_nodes.size(); ++i) {
    auto& body = body_of_node[part.elem_nodes[i]];
    demand(body < 0 || body == part.elem_body[i / 8], "bodies share no node");
    body = part.elem_body[i / 8];
  }
  demand(isBelow(part.elem_body, part.num_global_bodies), "bodies are numbered");
  for (const io::SideSet& set : part.side_sets) {
    demand(isBelow(set.elems, elems) && isBelow(set.sides, 6), "sides");
    demand(set.elems.size() == set.sides.size(), "sides of elements");
  }
  for (const io::NodeSet& set : part.node_sets)
    demand(isBelow(set.nodes, nodes) && std::is_sorted(set.nodes.begin(), set.nodes.end()),
           "nodes of sets");
}

// The mesh is the same after it is written and read. Names of the file format's limit may stop the
// writer.
inline void demandSameWhenWritten(const io::MeshPart& part) {
  const std::string path = folder() / "again.exo";
  try {
    io::writeMesh(MPI_COMM_SELF, path, part, {});
  } catch (const OutputError& error) {
    demand(*error.what() != 0, "a failure is explained");
    return;
  }
  const io::MeshPart again = io::readMesh(MPI_COMM_SELF, path);
  demand(again.coordinates == part.coordinates && again.elem_nodes == part.elem_nodes &&
             again.elem_block == part.elem_block && again.elem_body == part.elem_body,
         "nodes and elements are those that were written");
  demand(again.blocks.size() == part.blocks.size() &&
             again.side_sets.size() == part.side_sets.size() &&
             again.node_sets.size() == part.node_sets.size(),
         "as many blocks and sets as were written");
  for (std::size_t s = 0; s < part.side_sets.size(); ++s)
    demand(again.side_sets[s].elems == part.side_sets[s].elems &&
               again.side_sets[s].sides == part.side_sets[s].sides,
           "sides are those that were written");
  for (std::size_t s = 0; s < part.node_sets.size(); ++s)
    demand(again.node_sets[s].nodes == part.node_sets[s].nodes,
           "nodes of sets are those that were written");
}

} // namespace brickwall::fuzz
