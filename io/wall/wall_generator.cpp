// The wall's volume mesh in parallel.
#include "io/wall/wall_generator.hpp"

#include "contact/base/error.hpp"
#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "io/mesh/id_slices.hpp"
#include "io/mesh/local_numbering.hpp"
#include "io/mesh/partition.hpp"
#include "io/mesh/shared_nodes.hpp"

#include <algorithm>
#include <numeric>
#include <string>

namespace brickwall::io {

namespace {

// Global ids of the elements that belong to this rank, ascending.
std::vector<global_id> partitionElems(MPI_Comm comm, const WallLayout& wall) {
  const int size = sizeOf(comm), rank = rankOf(comm);
  const IdSlices slices{wall.numElems(), size};
  const global_id first = slices.begin(rank);
  const int count = checkedInt(slices.end(rank) - first, "generateWall: elements of a rank");
  std::vector<global_id> ids = hostArray<global_id>(count);
  std::iota(ids.begin(), ids.end(), first);
  if (size == 1)
    return ids;
  std::vector<double> centroids;
  centroids.reserve(3 * ids.size());
  for (const global_id elem : ids)
    for (const double x : wall.elemCentroid(elem))
      centroids.push_back(x);

  // Slices ascend with the rank.
  return sendTo(comm, partitionPoints(comm, ids, centroids, {}, CutPlanes::whole), ids);
}

// The elements of a brick on this rank, [first, end), and the nodes of the brick that they use.
struct BrickPart {
  const WallLayout& wall;
  const MeshPart& part;
  int first, end;
};

// The nodes of a brick that this rank uses, numbered from 0 on. Other ranks may have most of a large
// brick.
struct BrickNumbers {
  explicit BrickNumbers(const BrickPart& brick) {
    const auto nodesOf = [&](int elem) { return brick.wall.elemNodes(brick.part.elem_ids[elem]); };
    // Corners 0 and 6 have the lowest and highest number, and these ascend with the element.
    first = nodesOf(brick.first)[0];
    const global_id last = nodesOf(brick.end - 1)[6];
    local.assign(static_cast<std::size_t>(last + 1 - first), -1);
    for (int elem = brick.first; elem < brick.end; ++elem)
      for (const global_id node : nodesOf(elem))
        local[node - first] = 0;
    for (int& number : local)
      if (number == 0)
        number = count++;
  }

  global_id first;
  std::vector<int> local; // [node - first]; -1 for those of other ranks
  int count = 0;
};

// Elements in ascending order, and so brick by brick; the nodes of each brick follow those of the
// bricks before it.
void generateElems(const WallLayout& wall, MeshPart& part) {
  const int num_elems = part.numElems();
  part.elem_body = hostArray<global_id>(num_elems);
  part.elem_block = hostArray<int>(num_elems);
  parallelOnHost("io::generateWall::elements", num_elems, [&](std::int64_t elem) {
    const global_id brick = wall.brickOfElem(part.elem_ids[elem]);
    part.elem_body[elem] = brick;
    part.elem_block[elem] = wall.numWholeBricks() > 0 && brick >= wall.numWholeBricks() ? 1 : 0;
  });
  std::vector<BrickPart> bricks;
  for (int elem = 0; elem < num_elems; ++elem) {
    if (elem == 0 || part.elem_body[elem] != part.elem_body[elem - 1])
      bricks.push_back({wall, part, elem, elem});
    ++bricks.back().end;
  }
  const auto num_bricks = static_cast<std::int64_t>(bricks.size());
  std::vector<int> first_node(bricks.size() + 1, 0);
  parallelOnHost("io::generateWall::count", num_bricks,
                 [&](std::int64_t b) { first_node[b + 1] = BrickNumbers(bricks[b]).count; });
  std::partial_sum(first_node.begin(), first_node.end(), first_node.begin());
  part.node_ids = hostArray<global_id>(first_node.back());
  part.elem_nodes = hostArray<int>(8 * std::int64_t(num_elems));
  parallelOnHost("io::generateWall::number", num_bricks, [&](std::int64_t b) {
    const BrickPart& brick = bricks[b];
    const BrickNumbers numbers(brick);
    for (std::size_t i = 0; i < numbers.local.size(); ++i)
      if (numbers.local[i] >= 0)
        part.node_ids[first_node[b] + numbers.local[i]] = numbers.first + static_cast<global_id>(i);
    for (int elem = brick.first; elem < brick.end; ++elem) {
      int* corner = &part.elem_nodes[8 * std::size_t(elem)];
      for (const global_id node : wall.elemNodes(part.elem_ids[elem]))
        *corner++ = first_node[b] + numbers.local[node - numbers.first];
    }
  });
  part.coordinates = hostArray<double>(3 * std::int64_t(part.numNodes()));
  parallelOnHost("io::generateWall::nodes", part.numNodes(), [&](std::int64_t node) {
    const auto x = wall.nodeCoordinates(part.node_ids[node]);
    std::copy(x.begin(), x.end(), &part.coordinates[3 * node]);
  });
}

// bits_of(i) for i in [0, n).
template <class BitsOf>
std::vector<unsigned char> memberships(const char* label, int n, const BitsOf& bits_of) {
  std::vector<unsigned char> bits = hostArray<unsigned char>(n);
  parallelOnHost(label, n,
                 [&](std::int64_t i) { bits[i] = static_cast<unsigned char>(bits_of(i)); });
  return bits;
}

void generateSets(const WallLayout& wall, MeshPart& part) {
  const auto sides =
      memberships("io::generateWall::side_sets", part.numElems(),
                  [&](std::int64_t elem) { return wall.wallSides(part.elem_ids[elem]); });
  for (int s = 0; s < num_wall_sides; ++s) {
    const auto wall_side = static_cast<WallSide>(s);
    SideSet set;
    set.id = s + 1;
    set.name = WallLayout::sideSetName(wall_side);
    for (int elem = 0; elem < part.numElems(); ++elem)
      if (sides[elem] >> s & 1)
        set.elems.push_back(elem);
    set.sides.assign(set.elems.size(), WallLayout::hexSide(wall_side));
    part.side_sets.push_back(std::move(set));
  }
  const auto sets =
      memberships("io::generateWall::node_sets", part.numNodes(),
                  [&](std::int64_t node) { return wall.nodeSets(part.node_ids[node]); });
  for (int s = 0; s < num_wall_node_sets; ++s) {
    const auto wall_set = static_cast<WallNodeSet>(s);
    NodeSet set;
    set.id = s + 1;
    set.name = WallLayout::nodeSetName(wall_set);
    for (int node = 0; node < part.numNodes(); ++node)
      if (sets[node] >> s & 1)
        set.nodes.push_back(node);
    part.node_sets.push_back(std::move(set));
  }
}

} // namespace

MeshPart generateWall(MPI_Comm comm, const WallConfig& config) {
  const WallLayout wall(config);
  if (wall.numElems() / sizeOf(comm) > most_elems_of_rank)
    throw InputError("wall.bricks and wall.elements give " + std::to_string(wall.numElems()) +
                     " elements on " + std::to_string(sizeOf(comm)) +
                     " rank(s); expected at most " + std::to_string(most_elems_of_rank) +
                     " on each: use more ranks");
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
