// The wall's exterior surface alone, in parallel: the scene of `brickwall search`.
#include "io/wall/wall_generator.hpp"

#include "contact/base/mpi.hpp"
#include "io/mesh/id_slices.hpp"
#include "io/mesh/local_numbering.hpp"
#include "io/mesh/partition.hpp"
#include "io/mesh/shared_nodes.hpp"
#include "io/wall/hashed_random.hpp"

namespace brickwall::io {

namespace {

// Corners of hex8 sides in Exodus order, outward normal by the right-hand rule.
constexpr int side_corners[6][4] = {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6},
                                    {0, 4, 7, 3}, {0, 3, 2, 1}, {4, 5, 6, 7}};

std::array<global_id, 4> faceNodes(const WallLayout& wall, global_id face_id) {
  const auto nodes = wall.elemNodes(face_id / 6);
  const auto& corners = side_corners[face_id % 6];
  return {nodes[corners[0]], nodes[corners[1]], nodes[corners[2]], nodes[corners[3]]};
}

// Ids of the faces that belong to this rank, ascending.
std::vector<global_id> partitionFaces(MPI_Comm comm, const WallLayout& wall) {
  const int rank = rankOf(comm);
  const IdSlices slices{wall.numFaces(), sizeOf(comm)};
  const std::int64_t first = slices.begin(rank);
  const int count = checkedInt(slices.end(rank) - first, "generateWallSurface: faces of a rank");
  std::vector<global_id> ids(count);
  std::vector<double> centroids(3 * ids.size());
  for (int f = 0; f < count; ++f) {
    ids[f] = wall.faceId(first + f);
    const auto nodes = faceNodes(wall, ids[f]);
    const auto a = wall.nodeCoordinates(nodes[0]), b = wall.nodeCoordinates(nodes[2]);
    for (int d = 0; d < 3; ++d)
      centroids[3 * static_cast<std::size_t>(f) + d] = 0.5 * (a[d] + b[d]);
  }
  return sortedDistinct(sendTo(comm, partitionPoints(comm, ids, centroids), ids));
}

void appendJittered(const WallLayout& wall, const WallJitter& jitter, global_id node,
                    std::vector<double>& coordinates) {
  const auto position = wall.nodeCoordinates(node);
  for (int d = 0; d < 3; ++d) {
    const double edge = wall.config().brick[d] / static_cast<double>(wall.config().elements[d]);
    const double shift = jitter.amplitude * edge * hashedUniform(jitter.seed, node, d);
    coordinates.push_back(position[d] + shift);
  }
}

} // namespace

SurfacePart generateWallSurface(MPI_Comm comm, const WallConfig& config, const WallJitter& jitter) {
  const WallLayout wall(config);
  SurfacePart part;
  part.num_global_nodes = wall.numNodes();
  part.num_global_faces = wall.numFaces();
  part.face_ids = partitionFaces(comm, wall);
  rethrowOnAllRanks(comm, [&] {
    checkedInt(4 * static_cast<std::int64_t>(part.face_ids.size()),
               "generateWallSurface: face corners");
  });

  std::vector<global_id> corners;
  corners.reserve(4 * part.face_ids.size());
  part.face_body.reserve(part.face_ids.size());
  for (const global_id face : part.face_ids) {
    const auto nodes = faceNodes(wall, face);
    corners.insert(corners.end(), nodes.begin(), nodes.end());
    part.face_body.push_back(wall.brickOfElem(face / 6));
  }
  part.node_ids = sortedDistinct(corners);
  part.face_nodes = localIndices(part.node_ids, corners);

  part.coordinates.reserve(3 * part.node_ids.size());
  part.node_body.reserve(part.node_ids.size());
  for (const global_id node : part.node_ids) {
    appendJittered(wall, jitter, node, part.coordinates);
    part.node_body.push_back(wall.brickOfNode(node));
  }
  part.node_owner = findSharedNodes(comm, part.node_ids, part.num_global_nodes).node_owner;
  return part;
}

} // namespace brickwall::io
