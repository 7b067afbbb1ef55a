// The global search alone: boxes that differ in the last place, invariants of the partners,
// exports, reverse sums, errors thrown on all ranks. search_test.cpp compares its ghosts with brute
// force.
#include "tests/contact/search/search_checks.hpp"
#include "tests/support/communicator.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact::test {
namespace {

// One step; false when any rank found a difference.
bool checkGhosts(const SurfaceCase& c, GlobalSearch& search, const LocalSurface& local) {
  const exec_space space;
  const int rank = rankOf(comm);
  const GhostFaces& ghosts = search.findGhosts(space, local.surface);
  space.fence();
  const auto ok =
      ghostsAre(c, expectedOnRank(c, local, rank).ghosts, ghosts, search.config().method);
  EXPECT_TRUE(ok) << c.name() << ", " << nameOf(search.config().method) << ", rank " << rank;
  return okOnAllRanks(comm, ok);
}

// Two faces of two ranks, a gap of `ulps` units in the last place of 1 between the node and the
// face box: closed boxes overlap if it is not positive. All three cases are identical in floats.
TEST(GhostSearchTest, OneUnitInTheLastPlaceDecides) {
  const int size = sizeOf(comm);
  if (size == 1)
    GTEST_SKIP() << "needs two ranks";
  for (const int ulps : {-1, 0, 1})
    for (int d = 0; d < 3; ++d)
      for (const bool above : {false, true}) {
        SurfaceCase c;
        c.kind = "gap of " + std::to_string(ulps) + " ulp";
        for (int f = 0; f < 2; ++f) {
          std::array<int, 4> corners{};
          for (int k = 0; k < 4; ++k) {
            Point x{};
            x[(d + 1) % 3] = k == 1 || k == 2 ? 1 : 0;
            x[(d + 2) % 3] = k / 2;
            x[d] = 1;
            if (f == 1 && ulps != 0)
              x[d] = std::nextafter(1.0, (ulps > 0) == above ? 2.0 : 0.0);
            corners[k] = addNode(c, f, x);
            // Each is thick behind the plane, so that volumes overlap.
            if (k % 2 == 1)
              c.nodes[corners[k]].x_new[d] += (f == 1) == above ? 0.5 : -0.5;
          }
          addFace(c, f, corners);
          c.faces[f].rank = f == 0 ? 0 : size - 1;
          for (const int corner : corners) {
            c.nodes[corner].owner = c.faces[f].rank;
            c.nodes[corner].sharers = {c.faces[f].rank};
          }
        }
        const int rank = rankOf(comm);
        const auto expected = expectedOnRank(c, localSurface(c, rank), rank).ghosts.size();
        EXPECT_EQ(expected, ulps <= 0 && (rank == 0 || rank == size - 1) ? 1u : 0u);
        for (const SearchMethod method : all_methods) {
          GlobalSearch search(comm, configOf(c, method));
          EXPECT_TRUE(checkGhosts(c, search, localSurface(c, rank)))
              << c.kind << ", direction " << d << ", " << above;
        }
      }
}

// The same Views in every step, so that orders and trees are kept.
TEST(GhostSearchTest, AMovingSurfaceKeepsItsGhostsRight) {
  for (std::uint64_t seed = 0; seed < 60; seed += 5) {
    SurfaceCase c = makeCase(seed % 10 == 5 ? 7 + seed : 6 + seed, sizeOf(comm));
    LocalSurface local = localSurface(c, rankOf(comm));
    const View<double*[3]> x_old("test", local.nodes.size()), x_new("test", local.nodes.size());
    local.surface.coordinates_old = x_old;
    local.surface.coordinates_new = x_new;
    GlobalSearch search(comm, configOf(c, SearchMethod::cluster));
    Random random(seed);
    for (int step = 0; step < 8; ++step) {
      for (auto& node : c.nodes) {
        node.x_old = node.x_new;
        for (int d = 0; d < 3; ++d)
          node.x_new[d] += random.real(-0.2, 0.2) + 0.1 * static_cast<double>(node.body % 3);
      }
      const auto host_old = Kokkos::create_mirror_view(x_old);
      const auto host_new = Kokkos::create_mirror_view(x_new);
      for (std::size_t i = 0; i < local.nodes.size(); ++i)
        for (int d = 0; d < 3; ++d) {
          host_old(i, d) = c.nodes[local.nodes[i]].x_old[d];
          host_new(i, d) = c.nodes[local.nodes[i]].x_new[d];
        }
      Kokkos::deep_copy(x_old, host_old);
      Kokkos::deep_copy(x_new, host_new);
      ASSERT_TRUE(checkGhosts(c, search, local)) << c.name() << ", step " << step;
    }
  }
}

void expectPartnersAgree(const PartnerLists& sends_to, const PartnerLists& receives_from,
                         const SurfaceCase& c) {
  const int rank = rankOf(comm), size = sizeOf(comm);
  std::vector<int> sends(size * size, 0), receives(size * size, 0);
  for (const int q : sends_to.ranks)
    ++sends[rank * size + q];
  for (const int q : receives_from.ranks)
    ++receives[q * size + rank];
  allReduce(comm, sends.data(), size * size, MPI_SUM);
  allReduce(comm, receives.data(), size * size, MPI_SUM);
  EXPECT_EQ(sends, receives) << c.name(); // r in Q_snd(q) if and only if q in Q_rcv(r)
  EXPECT_EQ(sends[rank * size + rank], 0);
  for (const int count : sends)
    EXPECT_LE(count, 1); // no duplicates
}

TEST(GhostSearchTest, SendersAndReceiversAgreeOnPartners) {
  const exec_space space;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const SurfaceCase c = makeCase(seed, sizeOf(comm));
    const LocalSurface local = localSurface(c, rankOf(comm));
    for (const SearchMethod method : all_methods) {
      const SearchConfig config = configOf(c, method);
      const auto phases = makeSearchPhases(method);
      RankBoxes rank_boxes;
      exchangeRankBoxes(comm, local.surface, phases->constructBoxes(space, local.surface, config),
                        phases->keepsRankBoxes(), rank_boxes);
      phases->findPartnersAndCandidates(space, local.surface, rank_boxes, config, false);
      expectPartnersAgree(phases->nodesToSend(), phases->facesToTest(), c);
    }
  }
}

void shift(SurfaceCase& c, double by) {
  for (CaseNode& node : c.nodes) {
    node.x_old = node.x_new;
    node.x_new[0] += by;
  }
}

// A face is at least 0.5 long, so that the margin of a rank's boxes is at least 0.005.
TEST(GhostSearchTest, RankBoxesAreSentAnewOnlyWhenASurfaceLeavesOne) {
  for (const SearchMethod method : all_methods) {
    SurfaceCase c = makeCase(0, sizeOf(comm));
    GlobalSearch search(comm, configOf(c, method));
    const bool keeps = makeSearchPhases(method)->keepsRankBoxes();
    for (const double by : {0.0, 0.004, -0.004, 100.0, 0.004}) {
      shift(c, by);
      const std::int64_t before = search.numRankBoxExchanges();
      ASSERT_TRUE(checkGhosts(c, search, localSurface(c, rankOf(comm)))) << nameOf(method);
      const bool sends = !keeps || before == 0 || by == 100;
      EXPECT_EQ(search.numRankBoxExchanges() - before, sends) << nameOf(method) << ", " << by;
    }
  }
}

// The faces that the owners report as sent are the ghosts of the destinations, in the same order.
TEST(GhostSearchTest, SentFacesAreTheGhostsOfTheirDestinations) {
  const exec_space space;
  const int rank = rankOf(comm), size = sizeOf(comm);
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    for (const SearchMethod method : all_methods) {
      const SurfaceCase c = makeCase(seed, size);
      const LocalSurface local = localSurface(c, rank);
      GlobalSearch search(comm, configOf(c, method));
      const GhostFaces& ghosts = search.findGhosts(space, local.surface);
      const auto sent = search.sentFaces(space, local.surface);
      EXPECT_EQ(static_cast<std::int64_t>(sent.size()), search.statistics().faces_sent);
      std::vector<std::vector<global_id>> to(static_cast<std::size_t>(size));
      for (const SentFace& face : sent)
        to[static_cast<std::size_t>(face.destination)].push_back(face.face);
      std::vector<global_id> expected;
      for (const auto& from : exchangeByRank(comm, to))
        expected.insert(expected.end(), from.begin(), from.end());
      const auto ids = toHost(ghosts.face_ids);
      const std::vector<global_id> found(ids.data(), ids.data() + ghosts.count);
      EXPECT_EQ(found, expected) << c.name() << ", " << nameOf(method);
    }
}

// A search in floats may test slightly more candidates, never fewer; its hits are first hits.
TEST(GhostSearchTest, StatisticsOfTheMethodsAreConsistent) {
  const exec_space space;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const SurfaceCase c = makeCase(seed, sizeOf(comm));
    const LocalSurface local = localSurface(c, rankOf(comm));
    GlobalSearch cluster(comm, configOf(c, SearchMethod::cluster));
    GlobalSearch paper(comm, configOf(c, SearchMethod::paper));
    cluster.findGhosts(space, local.surface);
    paper.findGhosts(space, local.surface);
    const SearchStatistics a = cluster.statistics(), b = paper.statistics();
    EXPECT_GE(a.num_partners, b.num_partners) << c.name();
    EXPECT_GE(a.node_boxes_sent, b.node_boxes_sent) << c.name();
    EXPECT_GE(a.candidate_faces, b.candidate_faces) << c.name();
    EXPECT_EQ(a.faces_sent, b.faces_sent) << c.name();
    EXPECT_EQ(a.num_ghosts, b.num_ghosts) << c.name();
    EXPECT_EQ(a.overlapping_pairs, a.faces_sent) << c.name();
    EXPECT_GE(b.overlapping_pairs, b.faces_sent) << c.name();
  }
}

std::int64_t reactionOf(global_id face, int rank, int i) {
  return (face * 7919 + rank * 104729 + i * 31) * (i % 2 == 0 ? 1000003 : -1000033);
}

// The ghosts of a case, by the methods in turn.
struct FoundGhosts {
  explicit FoundGhosts(std::uint64_t run)
      : method(all_methods[run % 3]), c(makeCase(run / 3, sizeOf(comm))),
        local(localSurface(c, rankOf(comm))), search(comm, configOf(c, method)),
        ghosts(search.findGhosts(exec_space(), local.surface)) {}

  std::string name() const { return c.name() + ", " + nameOf(method); }
  // [ghost][3 * corner + xyz], of this rank
  View<std::int64_t* [12]> reactions() const {
    const auto ids = toHost(ghosts.face_ids);
    return viewOf<View<std::int64_t* [12]>>(
        static_cast<std::size_t>(ghosts.count), 12,
        [&](auto g, auto i) { return reactionOf(ids(g), rankOf(comm), static_cast<int>(i)); });
  }
  // What the reactions of all ranks add up to at the nodes, [node][xyz], of the ghosts for which
  // returns(face, holder) is true; counts these.
  template <class Returns>
  std::vector<std::array<std::int64_t, 3>> sumOfReactions(const Returns& returns,
                                                          std::int64_t& num_returned) const {
    const auto face_to_nodes = toHost(local.surface.face_to_nodes);
    std::vector<std::array<std::int64_t, 3>> sums(local.nodes.size(), {0, 0, 0});
    for (int q = 0; q < sizeOf(comm); ++q)
      for (const int f : expectedOnRank(c, localSurface(c, q), q).ghosts) {
        const auto own = std::find(local.faces.begin(), local.faces.end(), f);
        if (own == local.faces.end() || !returns(c.faces[f].id, q))
          continue;
        ++num_returned;
        for (int i = 0; i < 12; ++i)
          sums[face_to_nodes(own - local.faces.begin(), i / 3)][i % 3] +=
              reactionOf(c.faces[f].id, q, i);
      }
    return sums;
  }

  SearchMethod method;
  SurfaceCase c;
  LocalSurface local;
  GlobalSearch search;
  const GhostFaces& ghosts;
};

bool areEqual(const View<std::int64_t* [3]>& found,
              const std::vector<std::array<std::int64_t, 3>>& expected) {
  const auto host = toHost(found);
  for (std::size_t n = 0; n < expected.size(); ++n)
    for (int d = 0; d < 3; ++d)
      if (host(n, d) != expected[n][d])
        return false;
  return true;
}

TEST(GhostSearchTest, ReactionsOnGhostsReturnToTheirOwnersExactly) {
  const exec_space space;
  for (std::uint64_t run = 0; run < 60; ++run) {
    FoundGhosts found(run);
    const auto returned = viewOf<View<std::int64_t* [3]>>(
        found.local.nodes.size(), 3, [](auto, auto d) { return static_cast<std::int64_t>(d); });
    found.search.reverseSum(space, found.local.surface.face_to_nodes, found.reactions(), returned);
    space.fence();
    std::int64_t num_returned = 0;
    auto expected = found.sumOfReactions([](global_id, int) { return true; }, num_returned);
    for (auto& sum : expected)
      for (int d = 0; d < 3; ++d)
        sum[d] += d; // what was there before
    ASSERT_TRUE(okOnAllRanks(comm, areEqual(returned, expected))) << found.name();
  }
}

TEST(GhostSearchTest, ValuesAtNodesReachTheCornersOfGhosts) {
  const exec_space space;
  const auto valueOf = [](global_id node, int d) { return 0.25 * static_cast<double>(node) + d; };
  for (std::uint64_t run = 0; run < 60; ++run) {
    FoundGhosts found(run);
    const LocalSurface& local = found.local;
    const auto node_values =
        viewOf<View<const double* [3]>>(local.nodes.size(), 3, [&](auto n, auto d) {
          return valueOf(found.c.nodes[local.nodes[n]].id, static_cast<int>(d));
        });
    const View<double* [12]> values("test", static_cast<std::size_t>(found.ghosts.count));
    found.search.forward(space, local.surface, node_values, values);
    space.fence();
    const auto host = toHost(values);
    const auto corners = toHost(found.ghosts.corner_ids);
    bool ok = true;
    for (int g = 0; g < found.ghosts.count; ++g)
      for (int i = 0; i < 12; ++i)
        ok = ok && host(g, i) == valueOf(corners(g, i / 3), i % 3);
    ASSERT_TRUE(okOnAllRanks(comm, ok)) << found.name();
  }
}

// Of every third ghost; of none; of all.
bool isSelected(global_id face, int holder, int selection) {
  return selection == 2 || (selection == 0 && (face + holder) % 3 == 0);
}

// Values of the selected ghosts arrive, those of others stay 0, in both directions. Collective.
bool areSelectedValuesRight(FoundGhosts& found, int selection) {
  const exec_space space;
  const LocalSurface& local = found.local;
  const auto num_ghosts = static_cast<std::size_t>(found.ghosts.count);
  const auto ids = toHost(found.ghosts.face_ids);
  const auto corners = toHost(found.ghosts.corner_ids);
  const auto node_values =
      viewOf<View<const double* [3]>>(local.nodes.size(), 3, [&](auto n, auto d) {
        return static_cast<double>(10 * found.c.nodes[local.nodes[n]].id + static_cast<int>(d));
      });
  const auto is_selected = [&](global_id face, int holder) {
    return isSelected(face, holder, selection);
  };
  const auto flags = viewOf<View<unsigned char*>>(num_ghosts, 1, [&](auto g, auto) {
    return static_cast<unsigned char>(is_selected(ids(g), rankOf(comm)));
  });
  found.search.selectGhosts(space, flags);
  const View<double* [12]> values("test", num_ghosts);
  found.search.forwardSelected(space, local.surface, node_values, values);
  const View<std::int64_t* [3]> returned("test", local.nodes.size());
  found.search.reverseSumSelected(space, local.surface.face_to_nodes, found.reactions(), returned);
  space.fence();
  std::int64_t num_selected = 0;
  bool ok = areEqual(returned, found.sumOfReactions(is_selected, num_selected));
  ok = ok && found.search.selection().numFaces() == num_selected;
  const auto arrived = toHost(values);
  for (int g = 0; g < found.ghosts.count; ++g)
    for (int i = 0; i < 12; ++i)
      ok = ok && arrived(g, i) == (is_selected(ids(g), rankOf(comm))
                                       ? static_cast<double>(10 * corners(g, i / 3) + i % 3)
                                       : 0);
  return ok;
}

// The surface with each rank far from all others.
LocalSurface apart(const LocalSurface& local, int rank) {
  LocalSurface moved = local;
  for (auto* coordinates : {&moved.surface.coordinates_old, &moved.surface.coordinates_new}) {
    const auto x = toHost(*coordinates);
    *coordinates = viewOf<View<const double* [3]>>(
        x.extent(0), 3, [&](auto n, auto d) { return x(n, d) + (d == 0 ? 1e6 * rank : 0); });
  }
  return moved;
}

// Former partners that are none any more expect nothing. Collective.
bool isNothingReturnedApart(FoundGhosts& found) {
  const exec_space space;
  const LocalSurface moved = apart(found.local, rankOf(comm));
  const int num_ghosts = found.search.findGhosts(space, moved.surface).count;
  found.search.selectGhosts(space,
                            View<unsigned char*>("test", static_cast<std::size_t>(num_ghosts)));
  const View<std::int64_t* [3]> returned("test", moved.nodes.size());
  found.search.reverseSumSelected(space, moved.surface.face_to_nodes,
                                  View<std::int64_t* [12]>("test", num_ghosts), returned);
  space.fence();
  return areEqual(returned, std::vector<std::array<std::int64_t, 3>>(moved.nodes.size()));
}

TEST(GhostSearchTest, ValuesTravelForSelectedGhostsOnly) {
  for (std::uint64_t run = 0; run < 30; ++run) {
    FoundGhosts found(run);
    bool ok = true;
    for (int selection = 0; selection < 3; ++selection)
      ok = areSelectedValuesRight(found, selection) && ok;
    ok = isNothingReturnedApart(found) && ok;
    ASSERT_TRUE(okOnAllRanks(comm, ok)) << found.name();
  }
}

TEST(GhostSearchTest, DifferentNumbersOfFaceAttributesAreRefusedTogether) {
  const int rank = rankOf(comm), size = sizeOf(comm);
  if (size == 1)
    GTEST_SKIP() << "needs two ranks with faces";
  const exec_space space;
  SurfaceCase c = makeCase(0, size);
  for (std::size_t f = 0; f < c.faces.size(); ++f)
    c.faces[f].rank = static_cast<int>(f) % size;
  for (auto& node : c.nodes) {
    node.sharers.resize(static_cast<std::size_t>(size));
    for (int q = 0; q < size; ++q)
      node.sharers[q] = q;
  }
  LocalSurface local = localSurface(c, rank);
  if (rank == 1)
    local.surface.face_attributes = AttributeWords("test", local.faces.size(), 1);
  for (const SearchMethod method : all_methods) {
    GlobalSearch search(comm, configOf(c, method));
    for (int call = 0; call < 2; ++call) // also by those who try again
      EXPECT_THROW(search.findGhosts(space, local.surface), InputError) << nameOf(method);
  }
}

} // namespace
} // namespace brickwall::contact::test
