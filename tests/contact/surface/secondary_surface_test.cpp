// Faces that move to other ranks: each arrives once with its nodes and attributes, each node has
// one owner, values go to all copies and sums come back. Against lists that every rank can compute.
#include "contact/surface/secondary_surface.hpp"

#include "contact/base/to_device.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace {

using namespace brickwall;
using namespace brickwall::contact;

constexpr int side = 6; // faces along a side of a square grid, which belongs to body 3

// Rank r has the columns of faces with number r modulo ranks; nodes on their borders are shared.
// Besides, all ranks share node 100, also those without a face there.
struct Grid {
  exec_space space;
  int rank = rankOf(MPI_COMM_WORLD), num_ranks = sizeOf(MPI_COMM_WORLD);
  SweptBoxes surface;
  std::vector<global_id> face_ids, node_ids;

  static global_id cornerOf(global_id face, int j) {
    const global_id column = face / side, row = face % side;
    const int along[4] = {0, 1, 1, 0}, up[4] = {0, 0, 1, 1};
    return 100 + (column + along[j]) * (side + 1) + row + up[j];
  }
  Grid() {
    std::map<global_id, int> row_of;
    std::vector<int> corners;
    for (global_id face = 0; face < side * side; ++face) {
      if (face / side % num_ranks != rank)
        continue;
      face_ids.push_back(face);
      for (int j = 0; j < 4; ++j) {
        const auto found = row_of.emplace(cornerOf(face, j), static_cast<int>(node_ids.size()));
        if (found.second)
          node_ids.push_back(cornerOf(face, j));
        corners.push_back(found.first->second);
      }
    }
    if (row_of.count(100) == 0)
      node_ids.push_back(100);
    surface.num_faces = static_cast<int>(face_ids.size());
    surface.num_nodes = static_cast<int>(node_ids.size());
    surface.face_ids = toDevice(space, "face_ids", face_ids);
    surface.node_ids = toDevice(space, "node_ids", node_ids);
    surface.face_body = toDevice(space, "face_body", std::vector<global_id>(face_ids.size(), 3));
    surface.node_body = toDevice(space, "node_body", std::vector<global_id>(node_ids.size(), 3));
    surface.face_to_nodes = toDevice<View<int* [4]>>(space, "face_to_nodes", corners);
    const auto attributes =
        allocateAttributes<CornerMasses>(space, "attributes", surface.num_faces);
    const auto host = Kokkos::create_mirror_view(attributes);
    for (int face = 0; face < surface.num_faces; ++face)
      for (int j = 0; j < 4; ++j)
        attributesAt<CornerMasses>(host, face).corner_mass[j] =
            10. * static_cast<double>(face_ids[face]) + j;
    Kokkos::deep_copy(space, attributes, host);
    space.fence();
    surface.face_attributes = attributes;
  }
  int rankOfFace(global_id face) const { return static_cast<int>(face * face % num_ranks); }
  std::vector<int> ranksOfFaces() const {
    std::vector<int> ranks;
    for (const global_id face : face_ids)
      ranks.push_back(rankOfFace(face));
    return ranks;
  }
};

TEST(SecondarySurface, HasEachFaceOnItsRankWithNodesAndAttributes) {
  const Grid grid;
  const SecondarySurface moved(grid.space, MPI_COMM_WORLD, grid.surface, grid.ranksOfFaces());
  const Surface& surface = moved.surface();
  const auto face_ids = toHost(surface.face_ids), face_body = toHost(surface.face_body);
  const auto node_ids = toHost(surface.node_ids), node_body = toHost(surface.node_body);
  const auto corners = toHost(surface.face_to_nodes);
  const auto attributes = toHost(surface.face_attributes);
  std::set<global_id> found, expected;
  for (int face = 0; face < surface.num_faces; ++face) {
    found.insert(face_ids(face));
    EXPECT_EQ(face_body(face), 3);
    for (int j = 0; j < 4; ++j) {
      EXPECT_EQ(node_ids(corners(face, j)), Grid::cornerOf(face_ids(face), j));
      EXPECT_EQ(attributesAt<const CornerMasses>(attributes, face).corner_mass[j],
                10. * static_cast<double>(face_ids(face)) + j);
    }
  }
  for (global_id face = 0; face < side * side; ++face)
    if (grid.rankOfFace(face) == grid.rank)
      expected.insert(face);
  EXPECT_EQ(found, expected);
  EXPECT_EQ(static_cast<std::size_t>(surface.num_faces), expected.size());
  for (int node = 0; node < surface.num_nodes; ++node)
    EXPECT_EQ(node_body(node), 3);
}

TEST(SecondarySurface, HasOneOwnerOfEachNode) {
  const Grid grid;
  const SecondarySurface moved(grid.space, MPI_COMM_WORLD, grid.surface, grid.ranksOfFaces());
  const auto ids = toHost(moved.surface().node_ids);
  const auto is_owned = toHost(moved.surface().node_is_owned);
  std::vector<std::int64_t> owners((side + 1) * (side + 1), 0);
  for (int node = 0; node < moved.surface().num_nodes; ++node)
    owners[ids(node) - 100] += is_owned(node);
  allReduce(MPI_COMM_WORLD, owners.data(), static_cast<int>(owners.size()), MPI_SUM);
  for (const std::int64_t count : owners)
    EXPECT_EQ(count, 1);
}

TEST(SecondarySurface, PassesValuesToAllCopiesAndSumsBack) {
  const Grid grid;
  SecondarySurface moved(grid.space, MPI_COMM_WORLD, grid.surface, grid.ranksOfFaces());
  const int num_nodes = moved.surface().num_nodes;
  // value of a node: (id, -id)
  const View<double*[2]> values("values", grid.surface.num_nodes), passed("passed", num_nodes);
  const auto host = Kokkos::create_mirror_view(values);
  for (std::size_t i = 0; i < grid.node_ids.size(); ++i)
    for (int w = 0; w < 2; ++w)
      host(i, w) = (w == 0 ? 1 : -1) * static_cast<double>(grid.node_ids[i]);
  Kokkos::deep_copy(values, host);
  moved.forward(grid.space, values, passed);
  const auto got = toHost(passed);
  const auto ids = toHost(moved.surface().node_ids);
  for (int node = 0; node < num_nodes; ++node) {
    EXPECT_EQ(got(node, 0), static_cast<double>(ids(node)));
    EXPECT_EQ(got(node, 1), -static_cast<double>(ids(node)));
  }
  // Each copy holds id + its rank: the sum over all copies comes to every primary copy.
  const View<std::int64_t*[1]> sums("sums", num_nodes), back("back", grid.surface.num_nodes);
  const auto sums_host = Kokkos::create_mirror_view(sums);
  std::vector<std::int64_t> expected((side + 1) * (side + 1), 0);
  for (int node = 0; node < num_nodes; ++node) {
    sums_host(node, 0) = ids(node) + grid.rank;
    expected[ids(node) - 100] += ids(node) + grid.rank;
  }
  allReduce(MPI_COMM_WORLD, expected.data(), static_cast<int>(expected.size()), MPI_SUM);
  Kokkos::deep_copy(sums, sums_host);
  moved.sumShared(grid.space, sums);
  moved.giveBack(grid.space, sums, back);
  const auto back_host = toHost(back);
  for (std::size_t i = 0; i < grid.node_ids.size(); ++i)
    EXPECT_EQ(back_host(i, 0), expected[grid.node_ids[i] - 100]);
}

TEST(SecondarySurface, IsTheSameIfItIsKnownWhichNodesRanksShare) {
  const Grid grid;
  // The nodes that other ranks may have, of all ranks.
  std::vector<int> uses((side + 1) * (side + 1), 0);
  for (const global_id id : grid.node_ids)
    ++uses[id - 100];
  allReduce(MPI_COMM_WORLD, uses.data(), static_cast<int>(uses.size()), MPI_SUM);
  std::vector<char> is_shared;
  for (const global_id id : grid.node_ids)
    is_shared.push_back(uses[id - 100] > 1);
  const SecondarySurface of_all(grid.space, MPI_COMM_WORLD, grid.surface, grid.ranksOfFaces());
  SecondarySurface of_shared(grid.space, MPI_COMM_WORLD, grid.surface, grid.ranksOfFaces(),
                             is_shared);
  const Surface &a = of_all.surface(), &b = of_shared.surface();
  ASSERT_EQ(a.num_nodes, b.num_nodes);
  ASSERT_EQ(a.num_faces, b.num_faces);
  const auto ids_a = toHost(a.node_ids), ids_b = toHost(b.node_ids);
  const auto owned_a = toHost(a.node_is_owned), owned_b = toHost(b.node_is_owned);
  for (int node = 0; node < a.num_nodes; ++node) {
    EXPECT_EQ(ids_a(node), ids_b(node));
    EXPECT_EQ(owned_a(node), owned_b(node)) << ids_a(node);
  }
  const View<std::int64_t* [1]> copies("copies", b.num_nodes);
  Kokkos::deep_copy(copies, 1);
  of_shared.sumShared(grid.space, copies);
  std::vector<std::int64_t> expected((side + 1) * (side + 1), 0);
  for (int node = 0; node < b.num_nodes; ++node)
    ++expected[ids_b(node) - 100];
  allReduce(MPI_COMM_WORLD, expected.data(), static_cast<int>(expected.size()), MPI_SUM);
  const auto found = toHost(copies);
  for (int node = 0; node < b.num_nodes; ++node)
    EXPECT_EQ(found(node, 0), expected[ids_b(node) - 100]) << ids_b(node);
}

TEST(SecondarySurface, ForwardsRecordsToTheRanksOfTheirFaces) {
  const Grid grid;
  const SecondarySurface moved(grid.space, MPI_COMM_WORLD, grid.surface, grid.ranksOfFaces());
  struct Record {
    int face;
    global_id of_face; // its id
    int number;
  };
  // As many records of a face as its id modulo 3.
  std::vector<Record> records;
  for (std::size_t face = grid.face_ids.size(); face-- > 0;)
    for (int number = 0; number < grid.face_ids[face] % 3; ++number)
      records.push_back({static_cast<int>(face), grid.face_ids[face], number});
  const auto face_ids = toHost(moved.surface().face_ids);
  std::multiset<std::pair<global_id, int>> found, expected;
  for (const Record& record : moved.forwardRecords(Communicator(MPI_COMM_WORLD), records)) {
    ASSERT_LT(record.face, moved.surface().num_faces);
    EXPECT_EQ(face_ids(record.face), record.of_face);
    found.emplace(record.of_face, record.number);
  }
  for (global_id face = 0; face < side * side; ++face)
    for (int number = 0; number < face % 3 && grid.rankOfFace(face) == grid.rank; ++number)
      expected.emplace(face, number);
  EXPECT_EQ(found, expected);
}

// Nodes whose ids are multiples of `step` are selected, then others: only their values travel, both
// ways.
TEST(SecondarySurface, PassesValuesOfSelectedNodesOnly) {
  const Grid grid;
  SecondarySurface moved(grid.space, MPI_COMM_WORLD, grid.surface, grid.ranksOfFaces());
  const int num_nodes = moved.surface().num_nodes, num_primary = grid.surface.num_nodes;
  const auto ids = toHost(moved.surface().node_ids);
  for (const int step : {3, 1, 1000, 4}) {
    std::vector<unsigned char> flags(num_nodes);
    std::vector<double> of_primary(num_primary), of_copies(num_nodes);
    for (int node = 0; node < num_nodes; ++node) {
      flags[node] = ids(node) % step == 0;
      of_copies[node] = 2 * static_cast<double>(ids(node));
    }
    for (int node = 0; node < num_primary; ++node)
      of_primary[node] = static_cast<double>(grid.node_ids[node]);
    const View<unsigned char*> of_primary_flags("flags", num_primary);
    moved.selectNodes(grid.space, toDevice(grid.space, "flags", flags), of_primary_flags);
    const View<double*[1]> passed("passed", num_nodes), back("back", num_primary);
    moved.forwardSelected(
        grid.space, toDevice<View<double* [1]>>(grid.space, "of_primary", of_primary), passed);
    moved.giveBackSelected(grid.space,
                           toDevice<View<double* [1]>>(grid.space, "of_copies", of_copies), back);
    const auto got = toHost(passed), got_back = toHost(back);
    const auto got_flags = toHost(of_primary_flags);
    for (int node = 0; node < num_nodes; ++node)
      EXPECT_EQ(got(node, 0), flags[node] ? static_cast<double>(ids(node)) : 0) << step;
    for (int node = 0; node < num_primary; ++node) {
      const bool is_selected = grid.node_ids[node] % step == 0;
      EXPECT_EQ(got_flags(node) != 0, is_selected) << step;
      EXPECT_EQ(got_back(node, 0), is_selected ? 2 * of_primary[node] : 0) << step;
    }
  }
}

// Each rank selects other nodes: copies of a node that any rank selects add up on all ranks.
TEST(SecondarySurface, AddsUpValuesOfNodesThatAnyRankSelects) {
  const Grid grid;
  SecondarySurface moved(grid.space, MPI_COMM_WORLD, grid.surface, grid.ranksOfFaces());
  const int num_nodes = moved.surface().num_nodes;
  const auto ids = toHost(moved.surface().node_ids);
  std::vector<unsigned char> here(num_nodes);
  constexpr int num_ids = (side + 1) * (side + 1);
  std::vector<int> counts(2 * num_ids, 0); // of copies, and of those that select the node
  for (int node = 0; node < num_nodes; ++node) {
    here[node] = (ids(node) + grid.rank) % 5 == 0;
    ++counts[ids(node) - 100];
    counts[num_ids + ids(node) - 100] += here[node];
  }
  allReduce(MPI_COMM_WORLD, counts.data(), 2 * num_ids, MPI_SUM);
  const auto flags = toDevice(grid.space, "flags", here);
  moved.shared().selectShared(grid.space, flags);
  const View<std::int64_t* [1]> sums("sums", num_nodes);
  Kokkos::deep_copy(sums, 1);
  moved.shared().sumSelected(grid.space, sums);
  const auto got = toHost(sums);
  const auto got_flags = toHost(flags);
  const auto rows = toHost(moved.shared().selectedRows());
  const std::set<int> selected(rows.data(), rows.data() + rows.extent(0));
  for (int node = 0; node < num_nodes; ++node) {
    const int copies = counts[ids(node) - 100];
    const bool is_selected = counts[num_ids + ids(node) - 100] > 0;
    EXPECT_EQ(got_flags(node) != 0, is_selected) << ids(node);
    EXPECT_EQ(got(node, 0), is_selected ? copies : 1) << ids(node);
    EXPECT_EQ(selected.count(node) > 0, is_selected && copies > 1) << ids(node);
  }
}

TEST(SendToHolders, GivesEachRecordToTheRankThatListsItsId) {
  const int rank = rankOf(MPI_COMM_WORLD), num_ranks = sizeOf(MPI_COMM_WORLD);
  struct Record {
    global_id id;
    int from;
  };
  // Every rank has records of ids 0 to 49; rank (7 id) mod ranks holds id, but nobody holds 13.
  std::vector<Record> records;
  std::vector<global_id> held;
  for (global_id id = 0; id < 50; ++id) {
    records.push_back({id, rank});
    if (id != 13 && 7 * id % num_ranks == rank)
      held.push_back(id);
  }
  const auto received = sendToHolders(Communicator(MPI_COMM_WORLD), records, held,
                                      [](const Record& r) { return r.id; });
  std::multiset<std::pair<global_id, int>> found, expected;
  for (const Record& record : received)
    found.emplace(record.id, record.from);
  for (const global_id id : held)
    for (int q = 0; q < num_ranks; ++q)
      expected.emplace(id, q);
  EXPECT_EQ(found, expected);
}

} // namespace
