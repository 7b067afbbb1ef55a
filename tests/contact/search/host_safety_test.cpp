// A search in a host code: messages of the host that have the library's tags, surfaces that are
// wrong on one rank, and configurations that differ between ranks. Every error is thrown on all
// ranks; no rank hangs.
#include "contact/base/hash.hpp"
#include "contact/search/audit/read_back.hpp"
#include "contact/search/candidate_search.hpp"
#include "contact/surface/features/feature_edges.hpp"
#include "tests/contact/search/search_checks.hpp"
#include "tests/contact/support/host_traffic.hpp"
#include "tests/support/communicator.hpp"

#include <cmath>
#include <functional>

namespace brickwall::contact::test {
namespace {

constexpr double margin = 0.05;

// A row of bricks that touch: each rank has one of them at least, and neighbours beyond.
SurfaceCase rowOfBricks(int size) {
  SurfaceCase c;
  c.kind = "row of bricks";
  for (int body = 0; body <= size; ++body)
    addBrick(c, body, {1.0 * body, 0, 0}, {body + 1.0, 1, 1}, {3, 3, 3});
  for (auto& face : c.faces) {
    face.rank = static_cast<int>(face.body) % size;
    for (const int corner : face.corners) {
      c.nodes[corner].owner = face.rank;
      c.nodes[corner].sharers = {face.rank};
    }
  }
  c.node_tolerance = c.face_tolerance = 0.1;
  c.drop_same_body = true;
  return c;
}

class SearchInHost : public ::testing::Test {
protected:
  const int rank = rankOf(comm), size = sizeOf(comm);
  exec_space space;
  const SurfaceCase bricks = rowOfBricks(size);
};

std::vector<std::pair<global_id, global_id>>
pairsOf(const exec_space& space, const Surface& surface, const CandidateSearch& search) {
  std::vector<std::pair<global_id, global_id>> ids;
  for (const IdPair& pair : candidateIds(space, surface, search.ghosts(), search.pairs()))
    ids.emplace_back(pair.node, pair.face);
  return ids;
}

template <class ViewType>
using Mutable = Kokkos::View<typename ViewType::non_const_data_type, memory_space>;

// A copy of `view` with `rows` rows and a change.
template <class ViewType, class Change>
Mutable<ViewType> changed(const ViewType& view, std::size_t rows, const Change& change) {
  const Mutable<ViewType> copy("test::changed", rows);
  const auto host = Kokkos::create_mirror_view(copy);
  const auto from = toHost(view);
  for (std::size_t i = 0; i < std::min(rows, from.extent(0)); ++i)
    if constexpr (ViewType::rank == 1)
      host(i) = from(i);
    else
      for (std::size_t j = 0; j < from.extent(1); ++j)
        host(i, j) = from(i, j);
  change(host);
  Kokkos::deep_copy(copy, host);
  return copy;
}
template <class ViewType>
Mutable<ViewType> copied(const ViewType& view) {
  return changed(view, view.extent(0), [](const auto&) {});
}

// The message with which `act` throws InputError on this rank; empty if it does not.
std::string messageOf(const std::function<void()>& act) {
  try {
    act();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

// Expects the same message on all ranks, with these words in it.
void expectOnAllRanks(const std::string& message, const std::vector<std::string>& words,
                      const std::string& name) {
  EXPECT_EQ(broadcast(comm, message), message) << name;
  for (const std::string& word : words)
    EXPECT_NE(message.find(word), std::string::npos) << name << ": " << message;
}

struct Flaw {
  std::string name;
  std::function<void(Surface&)> bring;
  std::vector<std::string> words; // of the message
};

std::vector<Flaw> flaws() {
  std::vector<Flaw> all;
  const auto add = [&](const char* name, const std::vector<std::string>& words,
                       const std::function<void(Surface&)>& bring) {
    all.push_back({name, bring, words});
  };
#define BRICKWALL_ADD_VIEW(view)                                                                   \
  add("no " #view, {#view " is missing"}, [](Surface& s) { s.view = {}; });                        \
  add("short " #view, {#view " has "},                                                             \
      [](Surface& s) { s.view = changed(s.view, s.view.extent(0) - 1, [](const auto&) {}); });
  BRICKWALL_ADD_VIEW(coordinates_old)
  BRICKWALL_ADD_VIEW(coordinates_new)
  BRICKWALL_ADD_VIEW(face_to_nodes)
  BRICKWALL_ADD_VIEW(node_ids)
  BRICKWALL_ADD_VIEW(face_ids)
  BRICKWALL_ADD_VIEW(node_is_owned)
  BRICKWALL_ADD_VIEW(node_body)
  BRICKWALL_ADD_VIEW(face_body)
#undef BRICKWALL_ADD_VIEW
  add("short attributes", {"face_attributes has "}, [](Surface& s) {
    s.face_attributes = AttributeWords("test::short", s.num_faces - 1, num_test_attributes);
  });
  add("negative nodes", {"num_nodes is -1"}, [](Surface& s) { s.num_nodes = -1; });
  add("negative faces", {"num_faces is -7"}, [](Surface& s) { s.num_faces = -7; });
  add("corner too high", {"face_to_nodes(5, 2)"}, [](Surface& s) {
    s.face_to_nodes =
        changed(s.face_to_nodes, s.num_faces, [&](const auto& v) { v(5, 2) = s.num_nodes; });
  });
  add("corner too low", {"face_to_nodes(7, 0) is -1"}, [](Surface& s) {
    s.face_to_nodes = changed(s.face_to_nodes, s.num_faces, [](const auto& v) { v(7, 0) = -1; });
  });
  add("repeated node id", {"node_ids(3) and node_ids(9) are both"}, [](Surface& s) {
    s.node_ids = changed(s.node_ids, s.num_nodes, [](const auto& v) { v(9) = v(3); });
  });
  add("repeated face id", {"face_ids(0) and face_ids(11) are both"}, [](Surface& s) {
    s.face_ids = changed(s.face_ids, s.num_faces, [](const auto& v) { v(11) = v(0); });
  });
  add("negative node id", {"node_ids(2) is -4"}, [](Surface& s) {
    s.node_ids = changed(s.node_ids, s.num_nodes, [](const auto& v) { v(2) = -4; });
  });
  add("negative face id", {"face_ids(1) is -1"}, [](Surface& s) {
    s.face_ids = changed(s.face_ids, s.num_faces, [](const auto& v) { v(1) = -1; });
  });
  add("negative body", {"face_body(6) is -2"}, [](Surface& s) {
    s.face_body = changed(s.face_body, s.num_faces, [](const auto& v) { v(6) = -2; });
  });
  add("body too large", {"node_body(5) is 1099511627776; expected 0 to 2^40 - 1"}, [](Surface& s) {
    s.node_body =
        changed(s.node_body, s.num_nodes, [](const auto& v) { v(5) = global_id(1) << body_bits; });
  });
  return all;
}

// On the last rank alone, then on all.
TEST_F(SearchInHost, AWrongSurfaceIsOneErrorOnAllRanks) {
  const LocalSurface local = localSurface(bricks, rank);
  for (const SearchMethod method : all_methods)
    for (const Flaw& flaw : flaws())
      for (const int first_wrong : {size - 1, 0}) {
        if (method != SearchMethod::cluster && flaw.name != "no face_ids")
          continue; // the check is the same for all methods
        const std::string name = flaw.name + ", " + nameOf(method);
        Surface wrong = local.surface;
        if (rank >= first_wrong)
          flaw.bring(wrong);
        CandidateSearch search(comm, configOf(bricks, method), margin);
        std::vector<std::string> words = flaw.words;
        words.push_back("rank " + std::to_string(first_wrong));
        expectOnAllRanks(messageOf([&] { search.update(space, wrong); }), words, name);
        EXPECT_EQ(messageOf([&] { search.update(space, local.surface); }), "") << name;
        EXPECT_NE(messageOf([&] { search.update(space, wrong); }), "") << name;
      }
}

TEST_F(SearchInHost, FeatureEdgesCheckTheSurface) {
  const LocalSurface local = localSurface(bricks, rank);
  for (const Flaw& flaw : flaws()) {
    Surface wrong = local.surface;
    if (rank == size - 1)
      flaw.bring(wrong);
    expectOnAllRanks(messageOf([&] { findFeatureEdges(comm, wrong); }), flaw.words, flaw.name);
  }
}

TEST_F(SearchInHost, ASurfaceOfManyIdsInAnyOrderIsAccepted) {
  constexpr int n = 50000;
  Surface s;
  s.num_nodes = n;
  s.coordinates_old = s.coordinates_new = View<double* [3]>("test::x", n);
  s.face_to_nodes = View<int* [4]>("test::none", 0);
  s.face_ids = s.face_body = View<global_id*>("test::none", 0);
  s.node_body = View<global_id*>("test::body", n);
  s.node_is_owned = View<unsigned char*>("test::owned", n);
  const std::function<global_id(global_id)> ids[] = {
      [](global_id i) { return n - i; }, [](global_id i) { return (i * 7919) % n; },
      [](global_id i) { return (n - i) << 21; }, // all in a few bits of a table
      [](global_id i) { return static_cast<global_id>(hashOfWord(i) >> 1); }};
  for (const auto& id : ids) {
    s.node_ids = viewOf<View<const global_id*>>(n, 1, [&](auto i, auto) { return id(i); });
    EXPECT_EQ(messageOf([&] { checkSurface(space, comm, "test", s); }), "");
    s.node_ids = changed(s.node_ids, n, [](const auto& v) { v(40000) = v(17); });
    expectOnAllRanks(messageOf([&] { checkSurface(space, comm, "test", s); }),
                     {"node_ids(17) and node_ids(40000) are both"}, "many ids");
  }
}

TEST_F(SearchInHost, ConfigurationsThatDifferBetweenRanksAreAnError) {
  if (size == 1)
    return;
  const SearchConfig config = configOf(bricks, SearchMethod::cluster);
  const auto expect = [&](const char* word,
                          const std::function<void(SearchConfig&, double&)>& set) {
    SearchConfig mine = config;
    double my_margin = margin;
    if (rank == size - 1)
      set(mine, my_margin);
    const std::vector<std::string> words = {word, "on rank " + std::to_string(size - 1)};
    expectOnAllRanks(messageOf([&] { CandidateSearch(comm, mine, my_margin); }), words, word);
    if (std::string(word) != "margin")
      expectOnAllRanks(messageOf([&] { GlobalSearch(comm, mine); }), words, word);
  };
  expect("method is paper", [](SearchConfig& c, double&) { c.method = SearchMethod::paper; });
  expect("node_tolerance", [](SearchConfig& c, double&) { c.node_tolerance *= 1 + 1e-15; });
  expect("face_tolerance", [](SearchConfig& c, double&) { c.face_tolerance = -1; });
  expect("drop_same_body", [](SearchConfig& c, double&) { c.drop_same_body = false; });
  expect("margin", [](SearchConfig&, double& m) { m = 0; });
}

TEST_F(SearchInHost, TolerancesThatComeToDifferAreAnError) {
  if (size == 1)
    return;
  const LocalSurface local = localSurface(bricks, rank);
  CandidateSearch search(comm, configOf(bricks, SearchMethod::cluster), margin);
  search.update(space, local.surface);
  if (rank == size - 1)
    search.setTolerances(0.2, 0.2);
  expectOnAllRanks(messageOf([&] { search.update(space, local.surface); }), {"node_tolerance"},
                   "set later");
  search.setTolerances(0.2, 0.2);
  EXPECT_EQ(messageOf([&] { search.update(space, local.surface); }), "");
}

// A margin does not make good what a negative tolerance lacks.
TEST_F(SearchInHost, ToleranceThatCannotBeIsAnErrorOfTheNextUpdate) {
  const LocalSurface local = localSurface(bricks, rank);
  for (const double kept_by : {0.0, margin})
    for (const double wrong : {-0.1 * margin, std::nan(""), HUGE_VAL})
      for (const int first_wrong : {size - 1, 0}) {
        CandidateSearch search(comm, configOf(bricks, SearchMethod::cluster), kept_by);
        search.update(space, local.surface);
        if (rank >= first_wrong)
          search.setTolerances(0.1, wrong);
        for (int step = 0; step < 2; ++step)
          expectOnAllRanks(messageOf([&] { search.update(space, local.surface); }), {"tolerance"},
                           std::to_string(wrong));
        search.setTolerances(0.1, 0.1);
        EXPECT_EQ(messageOf([&] { search.update(space, local.surface); }), "");
      }
}

// Writes into a View of the surface.
template <class ViewType>
void changeInPlace(const ViewType& view,
                   const std::function<void(typename Mutable<ViewType>::HostMirror)>& change) {
  const auto source = changed(view, view.extent(0), change);
  if (view.extent(0) == 0)
    return;
  const Kokkos::View<typename ViewType::non_const_data_type, memory_space, Kokkos::MemoryUnmanaged>
      target(const_cast<typename ViewType::non_const_value_type*>(view.data()), view.extent(0));
  Kokkos::deep_copy(target, source);
}

TEST_F(SearchInHost, OtherCountsWithoutForgetAreAnErrorInEveryStep) {
  const LocalSurface local = localSurface(bricks, rank);
  Surface fewer = local.surface;
  if (rank == size - 1)
    --fewer.num_faces;
  for (const double kept_by : {0.0, margin}) {
    CandidateSearch search(comm, configOf(bricks, SearchMethod::cluster), kept_by);
    search.update(space, local.surface);
    for (int step = 0; step < 2; ++step)
      expectOnAllRanks(messageOf([&] { search.update(space, fewer); }),
                       {"forget()", "rank " + std::to_string(size - 1)}, "fewer faces");
    EXPECT_EQ(messageOf([&] { search.update(space, local.surface); }), "");
    if (rank == size - 1)
      search.forget();
    EXPECT_EQ(messageOf([&] { search.update(space, fewer); }), "");
  }
}

TEST_F(SearchInHost, OtherViewsAreFineIfTheirContentIsEqual) {
  const LocalSurface local = localSurface(bricks, rank);
  for (const double kept_by : {0.0, margin}) {
    CandidateSearch search(comm, configOf(bricks, SearchMethod::cluster), kept_by);
    search.update(space, local.surface);
    for (int step = 0; step < 3; ++step) {
      Surface other = local.surface;
      other.coordinates_new = copied(other.coordinates_new);
      other.face_to_nodes = copied(other.face_to_nodes);
      other.node_ids = copied(other.node_ids);
      other.node_is_owned = copied(other.node_is_owned);
      EXPECT_EQ(messageOf([&] { search.update(space, other); }), "");
    }
    EXPECT_EQ(search.searches(), kept_by > 0 ? 1 : 4);
  }
}

TEST_F(SearchInHost, OtherContentWithoutForgetIsAnError) {
  for (const double kept_by : {0.0, margin})
    for (const int what : {0, 1, 2, 3, 4})
      for (const bool in_place : {false, true}) {
        const LocalSurface local = localSurface(bricks, rank);
        Surface s = local.surface;
        CandidateSearch search(comm, configOf(bricks, SearchMethod::cluster), kept_by);
        search.update(space, s);
        const std::string name = std::to_string(what) + (in_place ? " in place" : "");
        if (rank == size - 1) {
          const auto change = [&](auto& view, const auto& to) {
            if (in_place)
              changeInPlace(view, to);
            else
              view = changed(view, view.extent(0), to);
          };
          if (what == 0)
            change(s.face_to_nodes, [](const auto& v) { std::swap(v(4, 1), v(4, 3)); });
          if (what == 1)
            change(s.face_ids, [](const auto& v) { v(0) += 1000000; });
          if (what == 2)
            change(s.node_ids, [](const auto& v) { v(30) += 1000000; });
          if (what == 3)
            change(s.node_is_owned, [](const auto& v) { v(8) = 0; });
          if (what == 4)
            change(s.node_body, [](const auto& v) { v(11) += 100; });
        }
        // In place it is noticed by one of sixteen searches, since each looks at a sixteenth of the
        // rows.
        std::string message;
        for (int step = 0; step < 16 && message.empty(); ++step) {
          if (in_place && kept_by > 0) // a step with a search
            s.coordinates_new = changed(s.coordinates_new, s.num_nodes, [&](const auto& v) {
              for (int node = 0; node < s.num_nodes; ++node)
                v(node, 2) += 1;
            });
          message = messageOf([&] { search.update(space, s); });
        }
        expectOnAllRanks(message, {"forget()", "rank " + std::to_string(size - 1)}, name);
        if (rank == size - 1)
          search.forget();
        EXPECT_EQ(messageOf([&] { search.update(space, s); }), "") << name;
      }
}

TEST_F(SearchInHost, MessagesOfTheHostDoNotMeetThoseOfTheSearch) {
  for (const SearchMethod method : all_methods)
    for (const double kept_by : {0.0, margin})
      for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const SurfaceCase c = seed == 9 ? bricks : makeCase(seed, size);
        const LocalSurface local = localSurface(c, rank);
        CandidateSearch alone(comm, configOf(c, method), kept_by);
        alone.update(space, local.surface);
        const auto expected = pairsOf(space, local.surface, alone);
        CandidateSearch search(comm, configOf(c, method), kept_by);
        for (const auto kind : {HostTraffic::pending_receives, HostTraffic::pending_messages}) {
          HostTraffic traffic(comm, kind);
          search.update(space, local.surface);
          EXPECT_TRUE(traffic.hasArrived()) << c.name();
          EXPECT_EQ(pairsOf(space, local.surface, search), expected) << c.name();
        }
        HostTraffic traffic(comm, HostTraffic::pending_receives);
        const View<std::int64_t* [12]> ghost_values("test::ghost_values", search.ghosts().count);
        const View<std::int64_t* [3]> node_values("test::node_values", local.surface.num_nodes);
        Kokkos::deep_copy(ghost_values, 1);
        search.reverseSum(space, local.surface.face_to_nodes, ghost_values, node_values);
        EXPECT_TRUE(traffic.hasArrived()) << c.name();
        std::int64_t sum = 0;
        const auto host = toHost(node_values);
        for (int node = 0; node < local.surface.num_nodes; ++node)
          for (int d = 0; d < 3; ++d)
            sum += host(node, d);
        EXPECT_EQ(allReduce(comm, sum, MPI_SUM),
                  12 * allReduce(comm, std::int64_t(search.ghosts().count), MPI_SUM));
      }
}

TEST_F(SearchInHost, MessagesOfTheHostDoNotMeetThoseOfSetUp) {
  const LocalSurface local = localSurface(bricks, rank);
  const FeatureEdges expected = findFeatureEdges(comm, local.surface);
  for (const auto kind : {HostTraffic::pending_receives, HostTraffic::pending_messages}) {
    HostTraffic traffic(comm, kind);
    const FeatureEdges found = findFeatureEdges(comm, local.surface);
    EXPECT_TRUE(traffic.hasArrived());
    EXPECT_EQ(found.face_edges, expected.face_edges);
    EXPECT_EQ(found.convex.size(), expected.convex.size());
  }
}

} // namespace
} // namespace brickwall::contact::test
