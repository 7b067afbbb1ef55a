// Sums of hashes, one for each node, element and entry of a set, so that order does not matter.
#include "miniapp/restart/checksums.hpp"

#include "contact/base/hash.hpp"
#include "contact/base/mpi.hpp"

namespace brickwall::miniapp {

std::uint64_t textChecksum(const std::string& text) {
  Hash hash;
  for (const char letter : text)
    hash.take(static_cast<std::int64_t>(letter));
  return hash.value();
}

std::uint64_t meshChecksum(MPI_Comm comm, const io::MeshPart& part) {
  std::uint64_t sum = 0;
  const auto owns = [&](std::size_t node) { return part.node_owner[node] == rankOf(comm); };
  const auto at = [](int index) { return static_cast<std::size_t>(index); };
  for (std::size_t node = 0; node < part.node_ids.size(); ++node) {
    if (!owns(node))
      continue;
    Hash hash;
    hash.take(part.node_ids[node]);
    for (std::size_t d = 0; d < 3; ++d)
      hash.take(part.coordinates[3 * node + d]);
    sum += hash.value();
  }
  std::vector<std::uint64_t> names; // of blocks
  for (const io::Block& block : part.blocks)
    names.push_back(textChecksum(block.name));
  for (std::size_t elem = 0; elem < part.elem_ids.size(); ++elem) {
    Hash hash;
    hash.take(part.elem_ids[elem]);
    hash.take(names[at(part.elem_block[elem])]);
    for (std::size_t c = 0; c < 8; ++c)
      hash.take(part.node_ids[at(part.elem_nodes[8 * elem + c])]);
    sum += hash.value();
  }
  for (const io::SideSet& set : part.side_sets) {
    const std::uint64_t name = textChecksum(set.name);
    for (std::size_t i = 0; i < set.elems.size(); ++i) {
      Hash hash;
      hash.take(name);
      hash.take(part.elem_ids[at(set.elems[i])]);
      hash.take(1 + set.sides[i]); // 0: a node
      sum += hash.value();
    }
  }
  for (const io::NodeSet& set : part.node_sets) {
    const std::uint64_t name = textChecksum(set.name);
    for (const int node : set.nodes) {
      if (!owns(at(node)))
        continue;
      Hash hash;
      hash.take(name);
      hash.take(part.node_ids[at(node)]);
      hash.take(0);
      sum += hash.value();
    }
  }
  return static_cast<std::uint64_t>(allReduce(comm, static_cast<std::int64_t>(sum), MPI_SUM));
}

} // namespace brickwall::miniapp
