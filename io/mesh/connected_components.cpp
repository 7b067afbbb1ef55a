// Union-find within the rank, then the lowest element id spreads through shared nodes until no
// label changes.
#include "io/mesh/connected_components.hpp"

#include "contact/base/group_by_key.hpp"
#include "contact/base/mpi.hpp"
#include "io/mesh/id_slices.hpp"
#include "io/mesh/local_numbering.hpp"

#include <algorithm>
#include <vector>

namespace brickwall::io {

namespace {

// Of local nodes.
DisjointSets joinElementNodes(const MeshPart& part) {
  DisjointSets sets(part.numNodes());
  for (std::size_t corner = 0; corner < part.elem_nodes.size(); ++corner)
    if (corner % 8 != 0)
      sets.join(part.elem_nodes[corner], part.elem_nodes[corner - 1]);
  return sets;
}

// Lowers the labels of roots to those of the other sharers of their nodes. True if any label here
// changed.
bool lowerLabels(const Communicator& comm, const MeshPart& part, DisjointSets& sets,
                 std::vector<global_id>& label_of_root) {
  std::vector<std::vector<global_id>> to_sharers(sizeOf(comm));
  for (const SharedNodes& shared : part.shared_nodes)
    for (const int node : shared.nodes)
      to_sharers[shared.rank].push_back(label_of_root[sets.rootOf(node)]);
  const auto received = exchangeByRank(comm, to_sharers);
  bool changed = false;
  for (const SharedNodes& shared : part.shared_nodes)
    for (std::size_t i = 0; i < shared.nodes.size(); ++i) {
      global_id& label = label_of_root[sets.rootOf(shared.nodes[i])];
      if (received[shared.rank][i] < label) {
        label = received[shared.rank][i];
        changed = true;
      }
    }
  return changed;
}

// Numbers the distinct labels of all ranks 0, 1, ... in their order, by rendezvous; replaces labels
// by their numbers.
global_id numberLabels(const Communicator& comm, const MeshPart& part,
                       std::vector<global_id>& labels) {
  const int size = sizeOf(comm);
  const IdSlices homes{part.num_global_elems, size};
  std::vector<std::vector<global_id>> questions(size);
  const std::vector<global_id> distinct = sortedDistinct(labels);
  for (const global_id label : distinct)
    questions[homes.rankOf(label)].push_back(label);
  auto asked = exchangeByRank(comm, questions);

  const std::vector<global_id> mine = sortedDistinct(joined(asked));
  // Homes hold ascending slices: the numbers of lower ranks come before those of this rank.
  const auto [first, total] = numbersFor(comm, static_cast<std::int64_t>(mine.size()));
  for (auto& from : asked)
    for (global_id& label : from)
      label = first + localIndex(mine, label);
  // Of `distinct`: queries went to homes in ascending order.
  const std::vector<global_id> numbers = joined(exchangeByRank(comm, asked));
  for (global_id& label : labels)
    label = numbers[localIndex(distinct, label)];
  return total;
}

} // namespace

void findBodies(MPI_Comm of_host, MeshPart& part) {
  const Communicator comm(of_host);
  DisjointSets sets = joinElementNodes(part);
  std::vector<global_id> label_of_root(part.node_ids.size(), part.num_global_elems);
  for (int elem = 0; elem < part.numElems(); ++elem) {
    global_id& label = label_of_root[sets.rootOf(part.elem_nodes[8 * std::size_t(elem)])];
    label = std::min(label, part.elem_ids[elem]);
  }
  while (allReduce(comm, lowerLabels(comm, part, sets, label_of_root) ? 1 : 0, MPI_MAX) != 0) {
  }
  part.elem_body.resize(part.elem_ids.size());
  for (int elem = 0; elem < part.numElems(); ++elem)
    part.elem_body[elem] = label_of_root[sets.rootOf(part.elem_nodes[8 * std::size_t(elem)])];
  part.num_global_bodies = numberLabels(comm, part, part.elem_body);
}

} // namespace brickwall::io
