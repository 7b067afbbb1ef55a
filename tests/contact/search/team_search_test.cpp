// The kernels of the cluster search for devices, run here: boxes and rows have the bits of those of
// hosts. Also the order in which the search keeps a surface.
#include "contact/search/cluster/cluster_pairs.hpp"
#include "contact/search/cluster/group_rows.hpp"
#include "contact/search/cluster/team_refit.hpp"
#include "tests/contact/search/search_checks.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace brickwall::contact::test {
namespace {

SurfaceCase makeWall(std::uint64_t seed, int elements) {
  SurfaceCase c;
  Random random(seed);
  c.kind = "wall";
  c.seed = seed;
  addWall(c, random, elements);
  if (seed == 12) // rows too long for a group
    addQuads(c, 100, 5, random, [](int, int k) { return Point{k % 2 * 1., k > 1 ? 1. : 0., 50.}; });
  moveNodes(c, random, seed % 2 == 0 ? 0.02 / elements : 0, 0.01 / elements); // or with ties
  c.node_tolerance = 0.1 / elements;
  c.face_tolerance = (seed % 3 == 0 ? 0.1 : 0.15) / elements;
  c.drop_same_body = seed % 4 == 1;
  distribute(c, random, 1);
  return c;
}

bool sameBits(const float* a, const float* b, std::int64_t count) {
  return memcmp(a, b, static_cast<std::size_t>(count) * sizeof(float)) == 0;
}

void placeRows(const exec_space& space, std::int64_t room, const View<std::int64_t*>& place) {
  Kokkos::parallel_for(
      "test::placeRows", rangePolicy(space, place.extent(0)),
      KOKKOS_LAMBDA(const std::int64_t i) { place(i) = i * room; });
}

TEST(TeamSearch, BoxesHaveTheBitsOfThoseOfHosts) {
  if (!host_accessible)
    GTEST_SKIP() << "on a host";
  const exec_space space;
  int most_levels = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const int elements = seed <= 8 ? static_cast<int>(seed % 4) + 1 : 16;
    SurfaceCase c = makeWall(seed, elements);
    if (seed % 3 == 1)
      c.nodes[7].x_new[1] = NAN;
    const SearchConfig config = configOf(c, SearchMethod::cluster);
    const LocalSurface local = localSurface(c, 0);
    const Surface& surface = local.surface;
    SurfaceClusters clusters;
    clusters.update(space, surface, config);
    const ClusterOrder& order = clusters.order();
    const BoxTree& expected = clusters.faceTree();
    BoxForest forest;
    forest.shape(space, std::int64_t(surface.num_faces));
    const std::int64_t num_floats = 6 * std::int64_t(surface.num_nodes);
    const View<float*> corners("corners", num_floats), nodes("nodes", num_floats);
    const RefitInput input{surface.coordinates_old,
                           surface.coordinates_new,
                           surface.node_ids,
                           order.node_order,
                           order.owned,
                           order.corners,
                           corners,
                           nodes,
                           View<float*>(),
                           forest.tree(0),
                           order.origin,
                           config.node_tolerance,
                           config.face_tolerance,
                           surface.num_nodes,
                           false};
    RefitScratch scratch;
    RefitSums sums;
    TeamRefit::refitNodes(space, input, scratch, sums);
    TeamRefit::refitFaces(space, input, scratch, sums);
    TeamRefit::read(space, scratch, sums);
    const bool is_same = config.node_tolerance == config.face_tolerance;
    ASSERT_TRUE(
        sameBits((is_same ? corners : nodes).data(), clusters.nodeBounds().data(), num_floats))
        << c.name();
    const BoxTree& found = forest.tree(0);
    ASSERT_EQ(found.num_levels, expected.num_levels);
    ASSERT_TRUE(sameBits(found.blocks, expected.blocks,
                         found.level_begin[max_levels] * std::int64_t(block_floats)))
        << c.name();
    const FloatBounds top = unionOfBlock(expected.block(expected.num_levels - 1, 0));
    EXPECT_TRUE(sameBits(sums.faces.side, top.side, 6));
    EXPECT_EQ(sums.num_invalid, clusters.rankBoxes().num_invalid);
    EXPECT_EQ(sums.first_invalid, clusters.rankBoxes().first_invalid);
    EXPECT_EQ(sums.num_invalid, seed % 3 == 1);
    most_levels = maxOf(most_levels, found.num_levels);
  }
  EXPECT_GT(most_levels, 4); // levels above those of a tile
}

global_id commonBody(const std::set<global_id>& bodies) {
  return bodies.size() == 1 ? *bodies.begin() : many_bodies;
}

TEST(ClusterOrder, KeepsBodiesTogetherIfTheirOwnPairsAreDropped) {
  const exec_space space;
  int num_mixed = 0, num_named = 0;
  for (const int elements : {1, 3, 8}) {
    SurfaceCase c = makeWall(7, elements);
    if (elements == 3) // a node that belongs to another body than the faces around it
      c.nodes[c.faces[0].corners[0]].body = c.nodes.back().body;
    const Surface surface = localSurface(c, 0).surface;
    const ClusterOrder order = orderSurface(space, surface, true);
    const auto face_order = toHost(order.face_order), node_order = toHost(order.node_order);
    const auto face_body = toHost(surface.face_body), node_body = toHost(surface.node_body);
    const auto face_to_nodes = toHost(surface.face_to_nodes);
    const auto block_body = toHost(order.block_body), cluster_body = toHost(order.cluster_body);
    std::map<global_id, int> last_block; // of a body
    for (int i = 0; i < surface.num_faces; ++i) {
      const global_id body = face_body(face_order(i));
      const int block = i / block_size;
      const int last = last_block.emplace(body, block).first->second;
      EXPECT_LE(block, last + 1) << "body " << body << " in two parts";
      last_block[body] = block;
    }
    for (int begin = 0; begin < surface.num_faces; begin += block_size) {
      std::set<global_id> bodies;
      for (int i = begin; i < std::min(begin + block_size, surface.num_faces); ++i) {
        bodies.insert(face_body(face_order(i)));
        for (int k = 0; k < 4; ++k)
          bodies.insert(node_body(face_to_nodes(face_order(i), k)));
      }
      EXPECT_EQ(block_body(begin / block_size), commonBody(bodies));
      ++(bodies.size() > 1 ? num_mixed : num_named);
    }
    for (int begin = 0; begin < surface.num_nodes; begin += cluster_size) {
      std::set<global_id> bodies;
      for (int i = begin; i < std::min(begin + cluster_size, surface.num_nodes); ++i)
        bodies.insert(node_body(node_order(i)));
      EXPECT_EQ(cluster_body(begin / cluster_size), commonBody(bodies));
    }
  }
  EXPECT_GT(num_mixed, 3);
  EXPECT_GT(num_named, 10 * num_mixed);
}

// Of two partners, each near some groups.
GroupsNearPartners nearPartners(int num_groups, std::uint64_t seed) {
  std::vector<unsigned> masks(2 * static_cast<std::size_t>(num_groups));
  for (std::size_t i = 0; i < masks.size(); ++i)
    masks[i] = (i * (seed + 1)) % 3 == 0 ? 1u << i % 32 : 0;
  View<unsigned*> on_device;
  copyToDevice(exec_space(), masks, on_device);
  return {on_device, 2};
}

TEST(TeamSearch, RowsOfGroupsAreThoseOfClusters) {
  const exec_space space;
  std::int64_t num_pairs = 0, num_skipped = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const SurfaceCase c = makeWall(seed, seed <= 10 ? static_cast<int>(seed % 5) + 1 : 16);
    const SearchConfig config = configOf(c, SearchMethod::cluster);
    const LocalSurface local = localSurface(c, 0);
    const Surface& surface = local.surface;
    const GhostFaces ghosts;
    SurfaceClusters clusters;
    clusters.update(space, surface, config);
    CandidatePairs pairs;
    ClusterPairs search;
    search.find(space, surface, ghosts, clusters, config, {}, pairs);

    constexpr int room = FindRowsOfGroups::max_row;
    const auto n = static_cast<std::size_t>(surface.num_nodes);
    const View<int*> capacity("capacity", n), begin("begin", 2 * n), faces("faces", room * n);
    const View<std::int64_t*> place("place", n);
    const View<unsigned char*> changed("changed", n);
    Kokkos::deep_copy(capacity, room);
    placeRows(space, room, place);
    GroupQueue queue;
    FindRowsOfGroups find{{surface, ghosts, clusters.order(),
                           DeviceRules(surface, ghosts, config.drop_same_body),
                           config.node_tolerance, config.face_tolerance, config.drop_same_body},
                          clusters.nodeBounds(),
                          clusters.faceTree(),
                          BoxTree(),
                          capacity,
                          place,
                          begin,
                          faces,
                          changed,
                          surface.num_nodes,
                          queue,
                          {}};
    // Two searches of all groups, and one of some groups before the others.
    for (int step = 0; step < 3; ++step) {
      PairCounts counts;
      std::vector<GroupsToSearch> launches = {{}};
      if (step == 2) {
        Kokkos::deep_copy(begin, 0);
        const auto near = nearPartners(find.numGroups(), seed);
        launches = {{GroupKind::far, near}, {GroupKind::near, near}};
      }
      for (const GroupsToSearch& groups : launches) {
        PairCounts of_launch;
        find.queue = queue;
        find.groups = groups;
        launchByGroups(space, find, PlusReducer<PairCounts>(of_launch), queue);
        space.fence();
        counts += of_launch;
      }
      EXPECT_EQ(counts.overflowed, 0);
      const HostRows expected(pairs);
      const auto rows = toHost(begin), found = toHost(faces);
      const auto marks = toHost(changed);
      std::int64_t pairs_found = 0, skipped = 0;
      for (int row = 0; row < surface.num_nodes; ++row) {
        if (rows(2 * row) == needs_retry) {
          ++skipped;
          continue;
        }
        const std::vector<int> of_row(found.data() + row * room,
                                      found.data() + row * room + rows(2 * row + 1));
        ASSERT_EQ(of_row, expected.faces(row)) << c.name() << ", row " << row;
        ASSERT_EQ(marks(row), step != 1 && !of_row.empty());
        pairs_found += rows(2 * row + 1);
      }
      EXPECT_EQ(counts.pairs, pairs_found);
      EXPECT_EQ(counts.skipped, skipped);
      num_pairs += pairs_found;
      num_skipped += skipped;
    }
  }
  EXPECT_GT(num_pairs, 10000);
  EXPECT_GT(num_skipped, 0);
}

} // namespace
} // namespace brickwall::contact::test
