// RCB, shared nodes and connected components, also where there is little or nothing to divide.
#include "tests/io/support/io_test_support.hpp"

#include "io/mesh/connected_components.hpp"
#include "io/mesh/id_slices.hpp"
#include "io/mesh/partition.hpp"
#include "io/mesh/redistribute.hpp"
#include "io/mesh/shared_nodes.hpp"
#include "io/wall/wall_generator.hpp"

#include <cmath>
#include <numeric>
#include <set>

namespace brickwall::io::testing {
namespace {

// `n` points on a line, or all in one place, given as slices; returns how many each rank got.
std::vector<std::int64_t> sharesOf(std::int64_t n, bool coincident, std::int64_t first_id,
                                   CutPlanes cut_planes = CutPlanes::divided) {
  const IdSlices slices{n, sizeOf(MPI_COMM_WORLD)};
  const int rank = rankOf(MPI_COMM_WORLD);
  std::vector<global_id> ids;
  std::vector<double> points;
  for (std::int64_t i = slices.begin(rank); i < slices.end(rank); ++i) {
    ids.push_back(first_id + i);
    for (int d = 0; d < 3; ++d)
      points.push_back(coincident ? 1.0 : static_cast<double>(d == 0 ? i : 0));
  }
  const std::vector<int> ranks = partitionPoints(MPI_COMM_WORLD, ids, points, {}, cut_planes);
  EXPECT_EQ(ranks.size(), ids.size());
  std::vector<std::int64_t> shares(sizeOf(MPI_COMM_WORLD), 0);
  for (const int q : ranks)
    ++shares.at(q);
  allReduce(MPI_COMM_WORLD, shares.data(), static_cast<int>(shares.size()), MPI_SUM);
  return shares;
}

TEST(IdSlices, CoverAllIdsOnceInOrder) {
  for (const std::int64_t total : {0, 1, 5, 7, 8, 100})
    for (const int ranks : {1, 2, 3, 7, 8}) {
      const IdSlices slices{total, ranks};
      EXPECT_EQ(slices.begin(0), 0);
      EXPECT_EQ(slices.end(ranks - 1), total);
      for (int r = 0; r < ranks; ++r)
        for (std::int64_t id = slices.begin(r); id < slices.end(r); ++id)
          EXPECT_EQ(slices.rankOf(id), r);
    }
}

TEST(Partition, SharesPointsEvenly) {
  const std::int64_t n = 10000;
  for (const std::int64_t share : sharesOf(n, false, 0))
    EXPECT_NEAR(static_cast<double>(share), static_cast<double>(n) / sizeOf(MPI_COMM_WORLD),
                0.02 * n);
}

TEST(Partition, SharesWeightsEvenly) {
  // Rank 0 has all points, on a line; the first tenth of them has nine tenths of the weight.
  std::vector<global_id> ids;
  std::vector<double> points;
  std::vector<float> weights;
  const int num_points = rankOf(MPI_COMM_WORLD) == 0 ? 1000 : 0;
  for (int i = 0; i < num_points; ++i) {
    ids.push_back(i);
    points.insert(points.end(), {1.0 * i, 0.0, 0.0});
    weights.push_back(i < 100 ? 81.f : 1.f);
  }
  std::vector<double> shares(sizeOf(MPI_COMM_WORLD), 0);
  const auto ranks = partitionPoints(MPI_COMM_WORLD, ids, points, weights);
  for (std::size_t i = 0; i < ranks.size(); ++i)
    shares[ranks[i]] += weights[i];
  allReduce(MPI_COMM_WORLD, shares.data(), static_cast<int>(shares.size()), MPI_SUM);
  // Each of the bisections is exact to half a point, and Zoltan accepts an imbalance of 1.1.
  for (const double share : shares)
    EXPECT_LE(share, 1.1 * 9000 / sizeOf(MPI_COMM_WORLD) + 81);
}

TEST(Partition, PlacesEveryPointAlsoWhereThereAreFewOrCoincidentOnesOrLargeIds) {
  for (const CutPlanes cut_planes : {CutPlanes::divided, CutPlanes::whole}) {
    const auto placed = [&](std::int64_t n, bool coincident, std::int64_t first_id) {
      const auto shares = sharesOf(n, coincident, first_id, cut_planes);
      return std::accumulate(shares.begin(), shares.end(), std::int64_t(0));
    };
    for (const std::int64_t n : {0, 1, 2, 3})
      EXPECT_EQ(placed(n, false, 0), n);
    EXPECT_EQ(placed(1000, true, 0), 1000);
    EXPECT_EQ(placed(500, false, (std::int64_t(1) << 40) + 12345), 500);
  }
}

// Equal shares would divide planes of elements on three ranks and more.
TEST(Partition, CutsBricksIntoLatticesOfElements) {
  WallConfig wall;
  wall.bricks = {5, 1, 7};
  wall.elements = {4, 3, 3};
  const MeshPart part = generateWall(MPI_COMM_WORLD, wall);
  for (int first = 0, end = 0; first < part.numElems(); first = end) {
    std::set<double> places[3]; // centres of the brick's elements
    for (; end < part.numElems() && part.elem_body[end] == part.elem_body[first]; ++end)
      for (int d = 0; d < 3; ++d) {
        double sum = 0;
        for (int c = 0; c < 8; ++c)
          sum += part.coordinates[3 * part.elem_nodes[8 * end + c] + d];
        places[d].insert(std::round(1e6 * sum));
      }
    EXPECT_EQ(places[0].size() * places[1].size() * places[2].size(),
              static_cast<std::size_t>(end - first))
        << "brick " << part.elem_body[first];
  }
}

TEST(SharedNodes, AreFoundOnBothSidesAndOwnedByTheLowest) {
  // Rank r has nodes r .. r + 2 of a row: each shared by up to three ranks.
  const int rank = rankOf(MPI_COMM_WORLD), size = sizeOf(MPI_COMM_WORLD);
  const std::vector<global_id> ids = {rank, rank + 1, rank + 2};
  const NodeSharing sharing = findSharedNodes(MPI_COMM_WORLD, ids, size + 2);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(sharing.node_owner[i], std::max(0, rank + i - 2));
  for (const SharedNodes& shared : sharing.sharers) {
    const int distance = std::abs(shared.rank - rank);
    ASSERT_LE(distance, 2);
    EXPECT_EQ(shared.nodes.size(), 3u - distance);
  }
}

// A bar of hexes in x; the hexes are dealt out to ranks in turn, so that every neighbour is
// elsewhere. Cut before the elements in `cuts`.
MeshPart dealtBars(int num_elems, const std::set<int>& cuts) {
  MeshPart part;
  const int rank = rankOf(MPI_COMM_WORLD), size = sizeOf(MPI_COMM_WORLD);
  std::vector<global_id> corners;
  global_id plane = 0; // first of four nodes at the left of the element
  for (int elem = 0; elem < num_elems; ++elem, plane += 4) {
    if (cuts.count(elem) > 0)
      plane += 4;
    if (elem % size != rank)
      continue;
    part.elem_ids.push_back(elem);
    for (int c = 0; c < 8; ++c)
      corners.push_back(plane + c);
  }
  part.node_ids = corners;
  std::sort(part.node_ids.begin(), part.node_ids.end());
  part.node_ids.erase(std::unique(part.node_ids.begin(), part.node_ids.end()), part.node_ids.end());
  for (const global_id node : corners)
    part.elem_nodes.push_back(
        static_cast<int>(std::lower_bound(part.node_ids.begin(), part.node_ids.end(), node) -
                         part.node_ids.begin()));
  part.num_global_elems = num_elems;
  part.num_global_nodes = plane + 4;
  NodeSharing sharing = findSharedNodes(MPI_COMM_WORLD, part.node_ids, part.num_global_nodes);
  part.node_owner = sharing.node_owner;
  part.shared_nodes = sharing.sharers;
  return part;
}

TEST(ConnectedComponents, AreFoundThroughManyRankCuts) {
  MeshPart part = dealtBars(40, {10, 11, 30});
  findBodies(MPI_COMM_WORLD, part);
  EXPECT_EQ(part.num_global_bodies, 4);
  for (int elem = 0; elem < part.numElems(); ++elem) {
    const global_id id = part.elem_ids[elem];
    EXPECT_EQ(part.elem_body[elem], id < 10 ? 0 : id < 11 ? 1 : id < 30 ? 2 : 3);
  }
}

TEST(ConnectedComponents, TakeASingleElement) {
  MeshPart part = dealtBars(1, {});
  findBodies(MPI_COMM_WORLD, part);
  EXPECT_EQ(part.num_global_bodies, 1);
}

// All lists of the parts, the sharers of nodes included.
void expectEqual(const MeshPart& a, const MeshPart& b) {
  EXPECT_EQ(a.node_ids, b.node_ids);
  EXPECT_EQ(a.coordinates, b.coordinates);
  EXPECT_EQ(a.node_owner, b.node_owner);
  EXPECT_EQ(a.elem_ids, b.elem_ids);
  EXPECT_EQ(a.elem_nodes, b.elem_nodes);
  EXPECT_EQ(a.elem_block, b.elem_block);
  EXPECT_EQ(a.elem_body, b.elem_body);
  ASSERT_EQ(a.side_sets.size(), b.side_sets.size());
  for (std::size_t s = 0; s < a.side_sets.size(); ++s) {
    EXPECT_EQ(a.side_sets[s].name, b.side_sets[s].name);
    EXPECT_EQ(a.side_sets[s].elems, b.side_sets[s].elems);
    EXPECT_EQ(a.side_sets[s].sides, b.side_sets[s].sides);
  }
  ASSERT_EQ(a.node_sets.size(), b.node_sets.size());
  for (std::size_t s = 0; s < a.node_sets.size(); ++s)
    EXPECT_EQ(a.node_sets[s].nodes, b.node_sets[s].nodes);
  ASSERT_EQ(a.shared_nodes.size(), b.shared_nodes.size());
  for (std::size_t s = 0; s < a.shared_nodes.size(); ++s) {
    EXPECT_EQ(a.shared_nodes[s].rank, b.shared_nodes[s].rank);
    EXPECT_EQ(a.shared_nodes[s].nodes, b.shared_nodes[s].nodes);
  }
}

TEST(Redistribute, MakesThePartsOfTheGenerator) {
  const MPI_Comm comm = MPI_COMM_WORLD;
  WallConfig wall;
  wall.bricks = {3, 1, 3};
  wall.elements = {4, 2, 2};
  const MeshPart part = generateWall(comm, wall);
  const WholeMesh whole = gatherMesh(comm, part);

  const auto ranksOf = [&](const MeshPart& of, const auto& rankFor) {
    std::vector<int> ranks;
    for (const global_id elem : of.elem_ids)
      ranks.push_back(rankFor(elem));
    return ranks;
  };
  const auto scattered = [&](global_id elem) {
    return static_cast<int>(elem * elem % 17 % sizeOf(comm));
  };
  const MeshPart mixed = redistribute(comm, part, ranksOf(part, scattered));
  EXPECT_TRUE(gatherMesh(comm, mixed) == whole);
  EXPECT_EQ(ranksOf(mixed, scattered), std::vector<int>(mixed.elem_ids.size(), rankOf(comm)));

  const MeshPart alone =
      redistribute(comm, mixed, std::vector<int>(mixed.elem_ids.size(), sizeOf(comm) - 1));
  if (rankOf(comm) == sizeOf(comm) - 1) {
    MeshPart serial = generateWall(MPI_COMM_SELF, wall);
    serial.node_owner.assign(serial.node_owner.size(), rankOf(comm));
    expectEqual(alone, serial);
  } else {
    EXPECT_EQ(alone.numNodes() + alone.numElems(), 0);
  }

  std::map<global_id, int> home; // of the generator
  const auto ids = gatherToAll(comm, part.elem_ids);
  for (std::size_t q = 0; q < ids.size(); ++q)
    for (const global_id elem : ids[q])
      home[elem] = static_cast<int>(q);
  expectEqual(redistribute(comm, mixed, ranksOf(mixed, [&](global_id elem) { return home[elem]; })),
              part);
}

} // namespace
} // namespace brickwall::io::testing
