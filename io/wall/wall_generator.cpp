// The wall's volume mesh in parallel.
#include "io/wall/wall_generator.hpp"

#include "contact/base/mpi.hpp"
#include "io/mesh/id_slices.hpp"
#include "io/mesh/local_numbering.hpp"
#include "io/mesh/partition.hpp"
#include "io/mesh/shared_nodes.hpp"

#include <numeric>

namespace brickwall::io {

namespace {

// Global ids of the elements that belong to this rank, ascending.
std::vector<global_id> partitionElems(MPI_Comm comm, const WallLayout& wall) {
  const int size = sizeOf(comm), rank = rankOf(comm);
  const IdSlices slices{wall.numElems(), size};
  const global_id first = slices.begin(rank);
  const int count = checkedInt(slices.end(rank) - first, "generateWall: elements of a rank");
  std::vector<global_id> ids(count);
  std::iota(ids.begin(), ids.end(), first);
  std::vector<double> centroids;
  centroids.reserve(3 * ids.size());
  for (const global_id elem : ids)
    for (const double x : wall.elemCentroid(elem))
      centroids.push_back(x);

  const std::vector<int> rank_of_elem = partitionPoints(comm, ids, centroids);
  std::vector<std::vector<global_id>> to_owners(size);
  for (int i = 0; i < count; ++i)
    to_owners[rank_of_elem[i]].push_back(ids[i]);
  std::vector<global_id> owned;
  for (const auto& received : exchangeByRank(comm, to_owners))
    owned.insert(owned.end(), received.begin(), received.end()); // slices ascend with the rank
  return owned;
}

void generateElems(const WallLayout& wall, MeshPart& part) {
  std::vector<global_id> corners;
  corners.reserve(8 * part.elem_ids.size());
  for (const global_id elem : part.elem_ids) {
    const auto nodes = wall.elemNodes(elem);
    corners.insert(corners.end(), nodes.begin(), nodes.end());
    const global_id brick = wall.brickOfElem(elem);
    part.elem_body.push_back(brick);
    part.elem_block.push_back(wall.numWholeBricks() > 0 && brick >= wall.numWholeBricks() ? 1 : 0);
  }
  part.node_ids = sortedDistinct(corners);
  part.elem_nodes = localIndices(part.node_ids, corners);
  part.coordinates.reserve(3 * part.node_ids.size());
  for (const global_id node : part.node_ids)
    for (const double x : wall.nodeCoordinates(node))
      part.coordinates.push_back(x);
}

void generateSets(const WallLayout& wall, MeshPart& part) {
  for (int s = 0; s < num_wall_sides; ++s) {
    const auto wall_side = static_cast<WallSide>(s);
    SideSet set;
    set.id = s + 1;
    set.name = WallLayout::sideSetName(wall_side);
    for (int elem = 0; elem < part.numElems(); ++elem)
      for (int side = 0; side < 6; ++side)
        if (wall.onWallSide(part.elem_ids[elem], side, wall_side)) {
          set.elems.push_back(elem);
          set.sides.push_back(side);
        }
    part.side_sets.push_back(std::move(set));
  }
  for (int s = 0; s < num_wall_node_sets; ++s) {
    const auto wall_set = static_cast<WallNodeSet>(s);
    NodeSet set;
    set.id = s + 1;
    set.name = WallLayout::nodeSetName(wall_set);
    for (int node = 0; node < part.numNodes(); ++node)
      if (wall.inNodeSet(part.node_ids[node], wall_set))
        set.nodes.push_back(node);
    part.node_sets.push_back(std::move(set));
  }
}

} // namespace

MeshPart generateWall(MPI_Comm comm, const WallConfig& config) {
  const WallLayout wall(config);
  MeshPart part;
  part.blocks = wall.blocks();
  part.num_global_nodes = wall.numNodes();
  part.num_global_elems = wall.numElems();
  part.num_global_bodies = wall.numBricks();

  part.elem_ids = partitionElems(comm, wall);
  rethrowOnAllRanks(comm, [&] {
    checkedInt(8 * static_cast<std::int64_t>(part.elem_ids.size()),
               "generateWall: element corners");
  });
  generateElems(wall, part);
  generateSets(wall, part);
  NodeSharing sharing = findSharedNodes(comm, part.node_ids, part.num_global_nodes);
  part.node_owner = std::move(sharing.node_owner);
  part.shared_nodes = std::move(sharing.sharers);
  return part;
}

} // namespace brickwall::io
