// The wall: its numbers, its geometry and its parts on any number of ranks.
#include "tests/io/support/io_test_support.hpp"

#include "io/wall/hashed_random.hpp"
#include "io/wall/shuffle_surface.hpp"
#include "io/wall/wall_generator.hpp"

#include <cmath>
#include <limits>

namespace brickwall::io::testing {
namespace {

// The walls W(n) of the paper's sizes.
WallConfig paperWall(std::int64_t n) {
  WallConfig config;
  config.bricks = {15, 1, 29};
  config.brick = {2, 1, 1};
  config.elements = {2 * n, n, n};
  config.ends = WallEnds::ragged;
  return config;
}

WallConfig wallOf(std::array<std::int64_t, 3> bricks, std::array<std::int64_t, 3> elements,
                  WallEnds ends, double gap = 0) {
  WallConfig config;
  config.bricks = bricks;
  config.elements = elements;
  config.ends = ends;
  config.gap = gap;
  return config;
}

std::vector<WallConfig> someWalls() {
  return {
      wallOf({3, 1, 3}, {2, 2, 2}, WallEnds::flush),
      wallOf({3, 2, 4}, {4, 1, 3}, WallEnds::flush, 0.01),
      wallOf({2, 2, 3}, {3, 2, 1}, WallEnds::ragged, 0.005),
      wallOf({1, 1, 2}, {2, 1, 1}, WallEnds::flush),
      wallOf({1, 1, 1}, {1, 1, 1}, WallEnds::flush),
      wallOf({4, 1, 1}, {3, 1, 2}, WallEnds::flush),
      wallOf({1, 3, 5}, {1, 1, 1}, WallEnds::ragged),
  };
}

// Faces of elements that belong to one element only, as sorted corner ids.
std::map<std::array<global_id, 4>, int> countFaces(const WholeMesh& mesh) {
  constexpr int corners[6][4] = {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6},
                                 {0, 4, 7, 3}, {0, 3, 2, 1}, {4, 5, 6, 7}};
  std::map<std::array<global_id, 4>, int> uses;
  for (const auto& [id, elem] : mesh.elems)
    for (const auto& side : corners) {
      std::array<global_id, 4> face;
      for (int c = 0; c < 4; ++c)
        face[c] = elem.nodes[side[c]];
      std::sort(face.begin(), face.end());
      ++uses[face];
    }
  return uses;
}

struct Range {
  double lower = std::numeric_limits<double>::max(), upper = -lower;
  void include(double x) { lower = std::min(lower, x), upper = std::max(upper, x); }
};

TEST(Wall, CountsTheFacesOfThePapersWalls) {
  const std::pair<std::int64_t, std::int64_t> walls[] = {
      {2, 17400}, {8, 278400}, {16, 1113600}, {32, 4454400}, {42, 7673400}, {64, 17817600}};
  for (const auto& [n, faces] : walls)
    EXPECT_EQ(WallLayout(paperWall(n)).numFaces(), faces);
  EXPECT_EQ(WallLayout(paperWall(64)).numElems(), 435LL * 2 * 64 * 64 * 64);
}

TEST(Wall, CountsAgreeWithTheMeshItself) {
  for (const WallConfig& config : someWalls()) {
    const WholeMesh mesh = gatherMesh(MPI_COMM_SELF, generateWall(MPI_COMM_SELF, config));
    EXPECT_EQ(static_cast<std::int64_t>(mesh.elems.size()), WallLayout(config).numElems());
    EXPECT_EQ(static_cast<std::int64_t>(mesh.nodes.size()), WallLayout(config).numNodes());
    std::int64_t exterior = 0;
    for (const auto& [face, uses] : countFaces(mesh)) {
      EXPECT_LE(uses, 2);
      exterior += uses == 1 ? 1 : 0;
    }
    EXPECT_EQ(exterior, WallLayout(config).numFaces());
    EXPECT_EQ(mesh.elems.rbegin()->first + 1, WallLayout(config).numElems());
    EXPECT_EQ(mesh.nodes.rbegin()->first + 1, WallLayout(config).numNodes());
  }
}

TEST(Wall, RefusesWhatCannotBeBuilt) {
  const auto refused = [](WallConfig config) {
    return errorOf([&] { generateWall(MPI_COMM_SELF, config); }).first == ExitCode::bad_input;
  };
  EXPECT_TRUE(refused(wallOf({0, 1, 1}, {2, 1, 1}, WallEnds::flush)));
  EXPECT_TRUE(refused(wallOf({1, 1, 1}, {2, 0, 1}, WallEnds::flush)));
  EXPECT_TRUE(refused(wallOf({2, 1, 2}, {3, 1, 1}, WallEnds::flush)));
  EXPECT_TRUE(refused(wallOf({2, 1, 2}, {2, 1, 1}, WallEnds::flush, -0.1)));
  EXPECT_TRUE(refused(wallOf({2, 1, 2}, {2, 1, 1}, WallEnds::flush, 0.2)));
  EXPECT_TRUE(refused(wallOf({2, 1, 2}, {2, 1, 1}, WallEnds::flush, std::nan(""))));
  EXPECT_TRUE(refused(wallOf({1LL << 30, 1LL << 30, 1LL << 30}, {2, 1, 1}, WallEnds::ragged)));
  EXPECT_TRUE(refused(wallOf({1LL << 30, 1, 1}, {1LL << 30, 8, 1}, WallEnds::ragged)));
  EXPECT_TRUE(refused(wallOf({400, 100, 100}, {8, 4, 4}, WallEnds::ragged))); // on one rank
}

TEST(Wall, FlushCoursesEndTogetherAndRaggedOnesHalfABrickApart) {
  for (const double gap : {0.0, 0.01}) {
    for (const WallEnds ends : {WallEnds::flush, WallEnds::ragged}) {
      const WallConfig config = wallOf({3, 1, 4}, {4, 1, 2}, ends, gap);
      const WallLayout wall(config);
      std::vector<Range> course_range(4);
      for (global_id node = 0; node < wall.numNodes(); ++node)
        course_range[wall.brickPlace(wall.brickOfNode(node)).course].include(
            wall.nodeCoordinates(node)[0]);
      const double length = 3 * config.brick[0] + 2 * gap;
      for (int course = 0; course < 4; ++course) {
        const bool shifted = ends == WallEnds::ragged && course % 2 == 1;
        const double shift = shifted ? 0.5 * (config.brick[0] + gap) : 0.0;
        // A handful of roundings of numbers below 1.
        EXPECT_NEAR(course_range[course].lower, shift, 1e-15);
        EXPECT_NEAR(course_range[course].upper, shift + length, 1e-15);
      }
    }
  }
}

TEST(Wall, NeighboursInACourseAreAGapApart) {
  for (const WallEnds ends : {WallEnds::flush, WallEnds::ragged}) {
    const double gap = 0.01;
    const WallConfig config = wallOf({3, 2, 3}, {2, 1, 1}, ends, gap);
    const WallLayout wall(config);
    // By course, wythe and place: extent in each direction.
    std::map<std::array<std::int64_t, 3>, std::array<Range, 3>> bricks;
    for (global_id node = 0; node < wall.numNodes(); ++node) {
      const BrickPlace place = wall.brickPlace(wall.brickOfNode(node));
      for (int d = 0; d < 3; ++d)
        bricks[{place.course, place.wythe, place.along}][d].include(wall.nodeCoordinates(node)[d]);
    }
    for (const auto& [place, extent] : bricks) {
      const auto expectGap = [&, &extent = extent](std::array<std::int64_t, 3> to, int d) {
        const auto neighbour = bricks.find(to);
        if (neighbour != bricks.end()) {
          EXPECT_NEAR(neighbour->second[d].lower - extent[d].upper, gap, 1e-15);
        }
      };
      expectGap({place[0], place[1], place[2] + 1}, 0);
      expectGap({place[0], place[1] + 1, place[2]}, 1);
      expectGap({place[0] + 1, place[1], place[2]}, 2);
    }
  }
}

TEST(Wall, TouchingBricksHaveTheSameBitsWhereTheyMeet) {
  const WallLayout wall(wallOf({5, 1, 4}, {6, 2, 3}, WallEnds::flush));
  std::array<std::set<double>, 3> values;
  for (global_id node = 0; node < wall.numNodes(); ++node)
    for (int d = 0; d < 3; ++d)
      values[d].insert(wall.nodeCoordinates(node)[d]);
  EXPECT_EQ(values[0].size(), 5u * 6 + 1);
  EXPECT_EQ(values[1].size(), 2u + 1);
  EXPECT_EQ(values[2].size(), 4u * 3 + 1);
}

TEST(Wall, ElementsAreRightHandedAndFillTheBricks) {
  for (const WallConfig& config : someWalls()) {
    const WallLayout wall(config);
    double volume = 0;
    for (global_id elem = 0; elem < wall.numElems(); ++elem) {
      const auto nodes = wall.elemNodes(elem);
      const auto a = wall.nodeCoordinates(nodes[0]);
      const auto x = wall.nodeCoordinates(nodes[1]), y = wall.nodeCoordinates(nodes[3]),
                 z = wall.nodeCoordinates(nodes[4]), g = wall.nodeCoordinates(nodes[6]);
      ASSERT_GT(x[0], a[0]);
      ASSERT_GT(y[1], a[1]);
      ASSERT_GT(z[2], a[2]);
      volume += (g[0] - a[0]) * (g[1] - a[1]) * (g[2] - a[2]);
      const ElemPlace place = wall.elemPlace(elem);
      EXPECT_EQ(wall.elemId(place), elem);
    }
    const double brick = config.brick[0] * config.brick[1] * config.brick[2];
    const double half = brick * (config.brick[0] - config.gap) / (2 * config.brick[0]);
    const double expected = static_cast<double>(wall.numWholeBricks()) * brick +
                            static_cast<double>(wall.numHalfBricks()) * half;
    EXPECT_NEAR(volume, expected, 1e-12 * expected);
  }
}

TEST(Wall, SideSetsAreTheOutsideAndNodeSetsTheirNodes) {
  const WallConfig config = wallOf({3, 2, 3}, {4, 2, 2}, WallEnds::flush);
  const WholeMesh mesh = gatherMesh(MPI_COMM_WORLD, generateWall(MPI_COMM_WORLD, config));
  const std::size_t along = 3 * 4, across = 2 * 2, up = 3 * 2;
  EXPECT_EQ(mesh.side_sets.at("front").size(), along * up);
  EXPECT_EQ(mesh.side_sets.at("back").size(), along * up);
  EXPECT_EQ(mesh.side_sets.at("left").size(), across * up);
  EXPECT_EQ(mesh.side_sets.at("right").size(), across * up);
  EXPECT_EQ(mesh.side_sets.at("bottom").size(), along * across);
  EXPECT_EQ(mesh.side_sets.at("top").size(), along * across);
  for (const auto& [elem, side] : mesh.side_sets.at("front")) {
    EXPECT_EQ(side, 0);
    EXPECT_EQ(mesh.nodes.at(mesh.elems.at(elem).nodes[0])[1], 0.0);
  }
  std::set<global_id> base, left;
  for (const auto& [id, x] : mesh.nodes) {
    if (x[2] == 0)
      base.insert(id);
    if (x[0] == 0)
      left.insert(id);
  }
  EXPECT_EQ(mesh.node_sets.at("base"), base);
  EXPECT_EQ(mesh.node_sets.at("left_end"), left);
  EXPECT_EQ(mesh.node_sets.at("base_course").size(), 3u * 2 * 5 * 3 * 3);
  EXPECT_EQ(mesh.node_sets.at("top_course").size(), 3u * 2 * 5 * 3 * 3);
  EXPECT_EQ(mesh.node_sets.at("right_end").size(), left.size());
  ASSERT_EQ(mesh.blocks.size(), 2u);
  EXPECT_EQ(mesh.blocks[0].first, "brick");
  EXPECT_EQ(mesh.blocks[1].first, "half_brick");
}

TEST(Wall, PartsMakeTheSameWallOnAnyNumberOfRanks) {
  for (const WallConfig& config : someWalls()) {
    const MeshPart part = generateWall(MPI_COMM_WORLD, config);
    expectConsistent(MPI_COMM_WORLD, part);
    const WholeMesh alone = gatherMesh(MPI_COMM_SELF, generateWall(MPI_COMM_SELF, config));
    EXPECT_TRUE(gatherMesh(MPI_COMM_WORLD, part) == alone);
    EXPECT_EQ(alone.num_bodies, WallLayout(config).numBricks());
  }
}

TEST(Wall, PartsAreBalanced) {
  const WallConfig config = wallOf({6, 1, 8}, {4, 2, 2}, WallEnds::flush);
  const MeshPart part = generateWall(MPI_COMM_WORLD, config);
  const double share = static_cast<double>(part.num_global_elems) / sizeOf(MPI_COMM_WORLD);
  // RCB cuts between planes of elements: a plane of this wall has at most 6 * 4 * 2 of them.
  EXPECT_LE(part.numElems(), share + 6 * 4 * 2);
}

TEST(WallSurface, IsTheExteriorOfTheMeshWithItsIds) {
  for (const WallConfig& config : someWalls()) {
    const SurfacePart part = generateWallSurface(MPI_COMM_WORLD, config);
    EXPECT_EQ(part.num_global_faces, WallLayout(config).numFaces());
    const WallLayout wall(config);
    const WholeMesh mesh = gatherMesh(MPI_COMM_SELF, generateWall(MPI_COMM_SELF, config));
    const auto uses = countFaces(mesh);
    EXPECT_TRUE(std::is_sorted(part.face_ids.begin(), part.face_ids.end()));
    EXPECT_TRUE(std::is_sorted(part.node_ids.begin(), part.node_ids.end()));

    std::set<global_id> ids;
    for (const auto& from : gatherToAll(MPI_COMM_WORLD, part.face_ids))
      for (const global_id id : from)
        EXPECT_TRUE(ids.insert(id).second);
    EXPECT_EQ(static_cast<std::int64_t>(ids.size()), part.num_global_faces);

    for (std::size_t f = 0; f < part.face_ids.size(); ++f) {
      std::array<global_id, 4> corners;
      std::array<double, 3> x[4], centre{};
      for (int c = 0; c < 4; ++c) {
        const int node = part.face_nodes[4 * f + c];
        corners[c] = part.node_ids[node];
        EXPECT_EQ(part.node_body[node], part.face_body[f]);
        for (int d = 0; d < 3; ++d) {
          x[c][d] = part.coordinates[3 * node + d];
          centre[d] += x[c][d] / 4;
        }
        EXPECT_EQ(x[c], mesh.nodes.at(corners[c]));
      }
      const auto inside = wall.elemCentroid(part.face_ids[f] / 6);
      double normal_out = 0; // (b - a) x (d - a) . (face centre - element centre)
      for (int d = 0; d < 3; ++d) {
        const int e = (d + 1) % 3, g = (d + 2) % 3;
        normal_out += ((x[1][e] - x[0][e]) * (x[3][g] - x[0][g]) -
                       (x[1][g] - x[0][g]) * (x[3][e] - x[0][e])) *
                      (centre[d] - inside[d]);
      }
      EXPECT_GT(normal_out, 0);
      EXPECT_EQ(mesh.elems.at(part.face_ids[f] / 6).body, part.face_body[f]);
      std::sort(corners.begin(), corners.end());
      EXPECT_EQ(uses.at(corners), 1);
    }
  }
}

TEST(WallSurface, NodesBelongToTheirLowestRank) {
  const SurfacePart part =
      generateWallSurface(MPI_COMM_WORLD, wallOf({4, 1, 5}, {4, 2, 2}, WallEnds::ragged));
  const auto ids_of_rank = gatherToAll(MPI_COMM_WORLD, part.node_ids);
  std::map<global_id, int> lowest;
  for (int q = 0; q < sizeOf(MPI_COMM_WORLD); ++q)
    for (const global_id id : ids_of_rank[q])
      lowest.emplace(id, q);
  for (std::size_t node = 0; node < part.node_ids.size(); ++node)
    EXPECT_EQ(part.node_owner[node], lowest.at(part.node_ids[node]));
}

TEST(WallSurface, JitterStaysInItsBoundsAndDoesNotDependOnRanks) {
  const WallConfig config = wallOf({4, 1, 5}, {4, 2, 2}, WallEnds::ragged);
  const WallLayout wall(config);
  const WallJitter jitter{0.01, 42};
  const SurfacePart part = generateWallSurface(MPI_COMM_WORLD, config, jitter);
  const SurfacePart alone = generateWallSurface(MPI_COMM_SELF, config, jitter);
  double largest = 0;
  for (std::size_t node = 0; node < part.node_ids.size(); ++node) {
    const auto found =
        std::lower_bound(alone.node_ids.begin(), alone.node_ids.end(), part.node_ids[node]);
    const auto other = static_cast<std::size_t>(found - alone.node_ids.begin());
    const auto at_rest = wall.nodeCoordinates(part.node_ids[node]);
    for (int d = 0; d < 3; ++d) {
      EXPECT_EQ(part.coordinates[3 * node + d], alone.coordinates[3 * other + d]);
      const double edge = config.brick[d] / static_cast<double>(config.elements[d]);
      const double moved = std::abs(part.coordinates[3 * node + d] - at_rest[d]) / edge;
      EXPECT_LE(moved, 0.01 * (1 + 1e-12));
      largest = std::max(largest, moved);
    }
  }
  if (!part.node_ids.empty()) {
    EXPECT_GT(largest, 0.009);
  }
}

// What a surface says of each face, whatever its local order: body, and id, place, owner and body
// of each corner.
using FaceFacts = std::vector<std::array<double, 6>>;
std::map<global_id, FaceFacts> factsByFace(const SurfacePart& part) {
  std::map<global_id, FaceFacts> facts;
  for (std::size_t f = 0; f < part.face_ids.size(); ++f) {
    FaceFacts& face = facts[part.face_ids[f]];
    face.push_back({static_cast<double>(part.face_body[f])});
    for (int c = 0; c < 4; ++c) {
      const auto node = static_cast<std::size_t>(part.face_nodes[4 * f + c]);
      face.push_back({static_cast<double>(part.node_ids[node]), part.coordinates[3 * node],
                      part.coordinates[3 * node + 1], part.coordinates[3 * node + 2],
                      static_cast<double>(part.node_owner[node]),
                      static_cast<double>(part.node_body[node])});
    }
  }
  return facts;
}

TEST(WallSurface, ShufflingChangesTheLocalOrderAndNothingElse) {
  const SurfacePart part = generateWallSurface(
      MPI_COMM_WORLD, wallOf({4, 1, 5}, {4, 2, 2}, WallEnds::ragged), WallJitter{0.01, 42});
  SurfacePart shuffled = part, again = part, other = part;
  shuffleSurface(5, shuffled);
  shuffleSurface(5, again);
  shuffleSurface(6, other);
  EXPECT_EQ(factsByFace(shuffled), factsByFace(part));
  EXPECT_EQ(shuffled.face_ids, again.face_ids);
  EXPECT_EQ(shuffled.node_ids, again.node_ids);
  if (part.face_ids.size() > 50) { // fewer may by chance keep their order
    EXPECT_NE(shuffled.face_ids, part.face_ids);
    EXPECT_NE(shuffled.node_ids, part.node_ids);
    EXPECT_NE(shuffled.face_ids, other.face_ids);
    // In a random order about half of the neighbours ascend: 5 standard errors of sqrt(n / 12).
    const auto& ids = shuffled.face_ids;
    double ascents = 0;
    for (std::size_t f = 1; f < ids.size(); ++f)
      ascents += ids[f] > ids[f - 1];
    const auto n = static_cast<double>(ids.size());
    EXPECT_NEAR(ascents, n / 2, 5 * std::sqrt(n / 12) + 1);
  }
}

TEST(HashedRandom, IsUniformAndDifferentForEachIdComponentAndSeed) {
  const int n = 100000;
  double sum = 0, squares = 0;
  std::set<double> distinct;
  for (int i = 0; i < n; ++i) {
    const double value = hashedUniform(7, i, 1);
    sum += value;
    squares += value * value;
    distinct.insert(value);
  }
  // Mean 0 and variance 1/3 within five standard errors.
  EXPECT_NEAR(sum / n, 0, 5 / std::sqrt(3.0 * n));
  EXPECT_NEAR(squares / n, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / n));
  EXPECT_EQ(distinct.size(), static_cast<std::size_t>(n));
  EXPECT_NE(hashedUniform(7, 3, 1), hashedUniform(7, 3, 2));
  EXPECT_NE(hashedUniform(7, 3, 1), hashedUniform(8, 3, 1));
}

} // namespace
} // namespace brickwall::io::testing
