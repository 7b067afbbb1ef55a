// Parallel reader: slices of the file, then all data go by rendezvous to the ranks that RCB
// assigns.
//
//   file slice of elements --RCB--> part            (home of an element: the rank that read it)
//   file slice of nodes    --asked for--> slice, part (home of a node: the rank that read it)
//   file slice of sets     --via home of element or node--> part
#include "io/exodus/mesh_reader.hpp"

#include "contact/base/mpi.hpp"
#include "io/exodus/exodus_slice.hpp"
#include "io/exodus/id_maps.hpp"
#include "io/mesh/connected_components.hpp"
#include "io/mesh/id_slices.hpp"
#include "io/mesh/local_numbering.hpp"
#include "io/mesh/partition.hpp"
#include "io/mesh/shared_nodes.hpp"

#include <algorithm>
#include <array>
#include <new>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace brickwall::io {

namespace {

struct NodeData {
  global_id id; // among used nodes
  global_id number;
  double x[3];
};

// Home of the nodes in the slice of this rank: numbers the used nodes and answers queries.
class NodeHome {
public:
  NodeHome(MPI_Comm comm, const MeshContents& contents, const MeshSlice& slice)
      : _comm(comm), _slices{contents.num_nodes, sizeOf(comm)}, _slice(slice),
        _begin(_slices.begin(rankOf(comm))), _id_of_node(slice.coordinates[0].size(), -1) {}

  // Numbers the nodes in `nodes` of any rank, in file order over all ranks. Collective; returns
  // their number.
  global_id numberUsed(const std::vector<global_id>& nodes) {
    for (const auto& from : exchangeByRank(_comm, byHome(nodes)))
      for (const global_id node : from)
        _id_of_node[node - _begin] = 0;
    auto [next, total] = numbersFor(_comm, std::count(_id_of_node.begin(), _id_of_node.end(), 0));
    for (global_id& id : _id_of_node)
      if (id == 0)
        id = next++;
    return total;
  }

  // Numbers and coordinates of `nodes` (ascending, used), in the same order. The home remembers the
  // ranks of the last query.
  // Collective.
  std::vector<NodeData> ask(const std::vector<global_id>& nodes) {
    const auto asked = exchangeByRank(_comm, byHome(nodes));
    _holders.clear();
    std::vector<std::vector<NodeData>> answers(asked.size());
    for (std::size_t q = 0; q < asked.size(); ++q)
      for (const global_id node : asked[q]) {
        const auto local = static_cast<std::size_t>(node - _begin);
        answers[q].push_back({_id_of_node[local],
                              _slice.node_numbers[local],
                              {_slice.coordinates[0][local], _slice.coordinates[1][local],
                               _slice.coordinates[2][local]}});
        _holders.emplace_back(node, static_cast<int>(q));
      }
    std::sort(_holders.begin(), _holders.end());
    return joined(exchangeByRank(_comm, answers)); // homes ascend with the rank
  }

  // Sends entries of node sets, with the new number of the node, to every rank of the last query
  // for the node.
  // Collective.
  std::vector<NodeEntry> distribute(const std::vector<NodeEntry>& entries) const {
    std::vector<std::vector<NodeEntry>> to_homes(sizeOf(_comm)), to_holders(sizeOf(_comm));
    for (const NodeEntry& entry : entries)
      to_homes[_slices.rankOf(entry.node)].push_back(entry);
    for (const auto& from : exchangeByRank(_comm, to_homes))
      for (const NodeEntry& entry : from) {
        auto holder =
            std::lower_bound(_holders.begin(), _holders.end(), std::make_pair(entry.node, 0));
        for (; holder != _holders.end() && holder->first == entry.node; ++holder)
          to_holders[holder->second].push_back({entry.set, _id_of_node[entry.node - _begin]});
      }
    return joined(exchangeByRank(_comm, to_holders));
  }

private:
  std::vector<std::vector<global_id>> byHome(const std::vector<global_id>& nodes) const {
    std::vector<std::vector<global_id>> lists(sizeOf(_comm));
    for (const global_id node : nodes)
      lists[_slices.rankOf(node)].push_back(node);
    return lists;
  }

  MPI_Comm _comm;
  IdSlices _slices;
  const MeshSlice& _slice;
  global_id _begin;
  std::vector<global_id> _id_of_node; // -1: no element uses it
  std::vector<std::pair<global_id, int>> _holders; // node, rank of the last query
};

std::vector<global_id> nodesOf(const std::vector<ElemCorners>& elems) {
  std::vector<global_id> nodes;
  for (const ElemCorners& elem : elems)
    nodes.insert(nodes.end(), elem.nodes, elem.nodes + 8);
  return nodes;
}

// Rank to which each element of the slice goes.
std::vector<int> placeElems(MPI_Comm comm, const MeshSlice& slice, NodeHome& home) {
  const std::vector<global_id> nodes = sortedDistinct(nodesOf(slice.elems));
  const std::vector<NodeData> data = home.ask(nodes);
  std::vector<global_id> ids;
  std::vector<double> centroids;
  for (const ElemCorners& elem : slice.elems) {
    ids.push_back(elem.elem);
    for (int d = 0; d < 3; ++d) {
      double sum = 0;
      for (const global_id node : elem.nodes)
        sum += data[localIndex(nodes, node)].x[d];
      centroids.push_back(sum / 8);
    }
  }
  return partitionPoints(comm, ids, centroids, {}, CutPlanes::whole);
}

void storeElems(const MeshContents& contents, const std::vector<ElemCorners>& elems,
                const std::vector<global_id>& file_nodes, const std::vector<NodeData>& data,
                MeshPart& part) {
  std::size_t block = 0;
  global_id end = contents.blocks[0].num_global_elems;
  for (const ElemCorners& elem : elems) {
    while (elem.elem >= end)
      end += contents.blocks[++block].num_global_elems;
    part.elem_ids.push_back(elem.elem);
    part.elem_numbers.push_back(elem.number);
    part.elem_block.push_back(static_cast<int>(block));
  }
  part.elem_nodes = localIndices(file_nodes, nodesOf(elems));
  for (const NodeData& node : data) {
    part.node_ids.push_back(node.id);
    part.node_numbers.push_back(node.number);
    part.coordinates.insert(part.coordinates.end(), node.x, node.x + 3);
  }
  part.dropPlainNumbers();
}

// The same element twice would have twice the mass and no skin. Collective.
void refuseRepeatedElems(MPI_Comm comm, const std::string& file_name, const MeshPart& part) {
  std::vector<std::array<global_id, 8>> corners(part.elem_ids.size());
  for (std::size_t elem = 0; elem < corners.size(); ++elem) {
    for (std::size_t c = 0; c < 8; ++c)
      corners[elem][c] = part.node_ids[static_cast<std::size_t>(part.elem_nodes[8 * elem + c])];
    std::sort(corners[elem].begin(), corners[elem].end());
  }
  const auto uses = countOnAllRanks(comm, corners, [](const auto& of_elem) { return of_elem[0]; });
  global_id repeated = part.num_global_elems; // the first one
  for (std::size_t elem = 0; elem < corners.size(); ++elem)
    if (uses[elem] > 1)
      repeated = std::min(repeated, part.elem_ids[elem]);
  repeated = allReduce(comm, repeated, MPI_MIN);
  if (repeated == part.num_global_elems)
    return;
  std::string name;
  rethrowOnAllRanks(comm, [&] { name = nameOfElem(file_name, repeated); });
  throw InputError(file_name + ": another element has the corners of " + name + " too");
}

// Side sets go through the home of the element, which knows to which rank the element went.
void distributeSides(MPI_Comm comm, const MeshContents& contents, const MeshSlice& slice,
                     const std::vector<int>& rank_of_elem, MeshPart& part) {
  const IdSlices slices{contents.num_elems, sizeOf(comm)};
  const global_id begin = slices.begin(rankOf(comm));
  std::vector<std::vector<SideEntry>> to_homes(sizeOf(comm)), to_owners(sizeOf(comm));
  for (const SideEntry& entry : slice.sides)
    to_homes[slices.rankOf(entry.elem)].push_back(entry);
  for (const auto& from : exchangeByRank(comm, to_homes))
    for (const SideEntry& entry : from)
      to_owners[rank_of_elem[entry.elem - begin]].push_back(entry);

  std::vector<std::tuple<std::int64_t, global_id, std::int64_t>> entries; // set, elem, side
  for (const auto& from : exchangeByRank(comm, to_owners))
    for (const SideEntry& entry : from)
      entries.emplace_back(entry.set, entry.elem, entry.side);
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  for (const SetInfo& info : contents.side_sets)
    part.side_sets.push_back({info.id, info.name, {}, {}});
  for (const auto& [set, elem, side] : entries) {
    part.side_sets[set].elems.push_back(localIndex(part.elem_ids, elem));
    part.side_sets[set].sides.push_back(static_cast<int>(side));
  }
}

void distributeNodeSets(const MeshContents& contents, const MeshSlice& slice, const NodeHome& home,
                        MeshPart& part) {
  std::vector<std::vector<global_id>> ids(contents.node_sets.size());
  for (const NodeEntry& entry : home.distribute(slice.nodes))
    ids[entry.set].push_back(entry.node);
  for (std::size_t s = 0; s < ids.size(); ++s)
    part.node_sets.push_back({contents.node_sets[s].id, contents.node_sets[s].name,
                              localIndices(part.node_ids, sortedDistinct(ids[s]))});
}

} // namespace

MeshPart readMesh(MPI_Comm comm, const std::string& file_name) {
  const int rank = rankOf(comm), size = sizeOf(comm);
  MeshContents contents;
  MeshSlice slice;
  IdMaps maps;
  rethrowOnAllRanks(comm, [&] {
    try {
      const ExodusFile file = ExodusFile::open(file_name);
      contents = readContents(file);
      slice = readSlice(file, contents, rank, size);
      maps = readIdMaps(file, contents, rank, size);
    } catch (const std::bad_alloc&) {
      throw InputError(file_name + ": does not fit into memory: damaged, or too large for " +
                       std::to_string(size) + (size == 1 ? " rank" : " ranks"));
    } catch (const std::length_error&) {
      throw InputError(file_name + ": is damaged: it holds a negative or impossible count");
    }
  });

  refuseRepeatedIds(comm, file_name, contents, maps);
  slice.node_numbers = std::move(maps.nodes);
  for (std::size_t i = 0; i < slice.elems.size(); ++i)
    slice.elems[i].number = maps.elems[i];

  MeshPart part;
  NodeHome home(comm, contents, slice);
  part.num_global_nodes = home.numberUsed(sortedDistinct(nodesOf(slice.elems)));
  part.num_global_elems = contents.num_elems;
  part.blocks = contents.blocks;
  part.empty_blocks = contents.empty_blocks;

  const std::vector<int> rank_of_elem = placeElems(comm, slice, home);
  const std::vector<ElemCorners> elems =
      sendTo(comm, rank_of_elem, slice.elems); // slices ascend with the rank
  rethrowOnAllRanks(comm, [&] {
    checkedInt(8 * static_cast<std::int64_t>(elems.size()), "readMesh: element corners");
  });
  const std::vector<global_id> file_nodes = sortedDistinct(nodesOf(elems));
  storeElems(contents, elems, file_nodes, home.ask(file_nodes), part);
  refuseRepeatedElems(comm, file_name, part);

  NodeSharing sharing = findSharedNodes(comm, part.node_ids, part.num_global_nodes);
  part.node_owner = std::move(sharing.node_owner);
  part.shared_nodes = std::move(sharing.sharers);
  distributeSides(comm, contents, slice, rank_of_elem, part);
  distributeNodeSets(contents, slice, home, part);
  findBodies(comm, part);
  return part;
}

} // namespace brickwall::io
