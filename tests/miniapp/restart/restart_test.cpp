// Which decks a checkpoint fits, history.csv that is continued, and the contact history as records.
// Whole runs that are interrupted and continued: tests/end_to_end/restart.py.
#include "contact/base/mpi.hpp"
#include "contact/enforcement/law/contact_records.hpp"
#include "io/wall/wall_generator.hpp"
#include "miniapp/output/history.hpp"
#include "miniapp/output/progress.hpp"
#include "miniapp/restart/checksums.hpp"
#include "miniapp/restart/deck_differences.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

namespace brickwall::miniapp::testing {
namespace {

using brickwall::testing::TemporaryFolder;

const char* const deck = "# resolved\ntitle = \"x\"\n[time]\nend = 1.0 # s\nsteps = 20\n\n"
                         "[[load.pressure]]\npeak = 1.0\n[limits]\nwall_time = 5.0\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(DeckDifference, IgnoresWhatResultsDoNotDependOn) {
  EXPECT_EQ(deckDifference(deck, deck), "");
  EXPECT_EQ(deckDifference(deck, replaced(deck, "steps = 20\n", "")), "");
  EXPECT_EQ(deckDifference(deck, replaced(deck, "wall_time = 5.0", "wall_time = 6.0")), "");
  EXPECT_EQ(deckDifference(deck, std::string(deck) + "[output.checkpoint]\nsteps = 3\n"), "");
  EXPECT_EQ(deckDifference(deck, std::string(deck) + "[partition]\ninterval = 3\n"), "");
  EXPECT_EQ(deckDifference(deck, std::string(deck) + "[skip]\nfree_bricks = false\n"), "");
  EXPECT_EQ(deckDifference(deck, replaced(deck, "\"x\"", "\"y\"")), "");
}

TEST(DeckDifference, NamesTheFirstKeyThatDiffers) {
  EXPECT_EQ(deckDifference(deck, replaced(deck, "peak = 1.0", "peak = 2.0")),
            "it was written with load.pressure[0].peak = 1.0, and the deck has "
            "load.pressure[0].peak = 2.0");
  EXPECT_NE(deckDifference(deck, replaced(deck, "end = 1.0", "end = 2.0")).find("--extend-to"),
            std::string::npos);
  const std::string damped = std::string(deck) + "[damping]\nmass = 1.0\n";
  EXPECT_EQ(deckDifference(deck, damped),
            "it was written without damping.mass, and the deck has damping.mass = 1.0");
  EXPECT_EQ(deckDifference(damped, deck),
            "it was written with damping.mass = 1.0, and the deck has no damping.mass");
  const std::string second = "[[load.pressure]]\npeak = 3.0\n";
  EXPECT_EQ(deckDifference(deck + second, deck + replaced(second, "3", "4")),
            "it was written with load.pressure[1].peak = 3.0, and the deck has "
            "load.pressure[1].peak = 4.0");
}

TEST(MeshChecksum, KnowsAllThatResultsDependOn) {
  const MPI_Comm comm = MPI_COMM_WORLD;
  io::WallConfig wall;
  wall.bricks = {2, 1, 2};
  wall.elements = {2, 1, 1};
  const io::MeshPart whole = io::generateWall(MPI_COMM_SELF, wall);
  const std::uint64_t expected = meshChecksum(MPI_COMM_SELF, whole);
  EXPECT_EQ(meshChecksum(comm, io::generateWall(comm, wall)), expected);
  const auto changed = [&](const auto& change) {
    io::MeshPart part = whole;
    change(part);
    return meshChecksum(MPI_COMM_SELF, part) != expected;
  };
  EXPECT_TRUE(changed([](auto& part) { part.coordinates[4] += 1e-9; }));
  EXPECT_TRUE(changed([](auto& part) { std::swap(part.elem_nodes[0], part.elem_nodes[1]); }));
  EXPECT_TRUE(changed([](auto& part) { part.blocks[0].name = "clay"; }));
  EXPECT_TRUE(changed([](auto& part) { part.side_sets[0].name = "other"; }));
  EXPECT_TRUE(changed([](auto& part) { part.side_sets[0].sides[0] ^= 1; }));
  EXPECT_TRUE(changed([](auto& part) { part.node_sets[0].name = "other"; }));
  EXPECT_TRUE(changed([](auto& part) { part.node_sets[0].nodes.pop_back(); }));
  EXPECT_FALSE(changed([](auto& part) { std::swap(part.side_sets[0], part.side_sets[1]); }));
}

TEST(Progress, EstimatesTheTimeLeftFromTheStepsOfThisRun) {
  // 100 steps in 10 s since step 500; 1400 steps are left.
  EXPECT_EQ(progressLine({600, 2000, 500, 0.25, 10, 1.2e-5, 42}),
            "step 600 of 2000  time 0.25  30 %  10 steps/s  2:20 left  energy error 1.2e-05  42 "
            "contacts");
  EXPECT_EQ(progressLine({600, 100600, 500, 0.25, 10, 0, 0}),
            "step 600 of 100600  time 0.25  1 %  10 steps/s  2:46:40 left  energy error 0.0e+00  0 "
            "contacts");
  EXPECT_EQ(progressLine({0, 10, 0, 0, 0, 0, 0}),
            "step 0 of 10  time 0  0 %  energy error 0.0e+00  0 contacts");
  EXPECT_EQ(Progress::chooseStyle(true), Progress::Style::none);
}

std::string contentOf(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(HistoryWriter, ContinuesAfterTheRowsOfACheckpoint) {
  const MPI_Comm comm = MPI_COMM_WORLD;
  const TemporaryFolder folder(comm);
  const std::string path = folder / "history.csv";
  const std::vector<std::string> columns = {"step", "time"};
  {
    HistoryWriter history(comm, path, columns);
    for (int step = 0; step < 5; ++step)
      history.write({static_cast<double>(step), 0.1 * step});
    EXPECT_EQ(history.numRows(), 5);
  }
  if (rankOf(comm) == 0) // a torn row
    std::ofstream(path, std::ios::app) << "5,0.";
  barrier(comm);
  EXPECT_EQ(HistoryWriter::whyNotContinued(comm, path, columns, 5), "");
  EXPECT_NE(HistoryWriter::whyNotContinued(comm, path, columns, 6), "");
  EXPECT_NE(HistoryWriter::whyNotContinued(comm, path, {"step"}, 1), "");
  EXPECT_NE(HistoryWriter::whyNotContinued(comm, path + ".none", columns, 1), "");
  {
    HistoryWriter history(comm, path, columns, 2);
    history.write({7, 0.5});
    EXPECT_EQ(history.numRows(), 3);
  }
  barrier(comm);
  EXPECT_EQ(contentOf(path), "step,time\n0,0\n1,0.1\n7,0.5\n");
}

// Calls itself with every double of a record.
struct SetDoubles {
  double& next;
  void operator()(const char*, double& value) const { value = next++; }
  void operator()(const char*, Vec3& value) const {
    for (int d = 0; d < 3; ++d)
      value[d] = next++;
  }
  void operator()(const char*, double (&values)[4]) const {
    for (double& value : values)
      value = next++;
  }
  void operator()(const char*, int&) const {}
  void operator()(const char*, bool&) const {}
  void operator()(const char*, global_id&) const {}
};
struct TakeDoubles {
  std::vector<double>& all;
  void operator()(const char*, const double& value) const { all.push_back(value); }
  void operator()(const char*, const Vec3& value) const {
    for (int d = 0; d < 3; ++d)
      all.push_back(value[d]);
  }
  void operator()(const char*, const double (&values)[4]) const {
    all.insert(all.end(), values, values + 4);
  }
  void operator()(const char*, const int& value) const { all.push_back(value); }
  void operator()(const char*, const bool& value) const { all.push_back(value); }
  void operator()(const char*, const global_id& value) const {
    all.push_back(static_cast<double>(value));
  }
};
std::vector<double> valuesOf(const contact::ContactRecord& record) {
  std::vector<double> all;
  contact::visitFields(record, TakeDoubles{all});
  return all;
}

TEST(ContactRecords, MakeTheHistoryAgainInAnyOrder) {
  const exec_space space;
  const auto ids = toDevice<View<global_id*>>(space, "ids", std::vector<global_id>{40, 10, 30});
  const auto atRow = [](int row) {
    contact::ContactPoint point;
    point.node[0] = row;
    point.node[1] = row + 1;
    return point;
  };
  std::vector<contact::ContactRecord> records(4);
  const global_id nodes[4] = {30, 40, 30, 40}, sides[4] = {9, 2, 3, 1};
  double next = 1;
  for (int i = 0; i < 4; ++i) {
    contact::visitFields(records[i], SetDoubles{next});
    records[i].node = nodes[i];
    records[i].pair.side = sides[i];
    records[i].pair.is_retained = i % 2;
    records[i].pair.fade_weight = 0.5;
    records[i].pair.settles = i % 2 == 0;
  }
  contact::ContactRecord of_ended; // a contact that ended seven steps ago
  of_ended.node = 10;
  of_ended.steps_since = 7;
  records.push_back(of_ended);
  contact::ContactHistory history;
  history.interactions = StructArray<contact::Interaction>("interactions");
  history.friction = StructArray<contact::FrictionSpring>("friction");
  history.fading = StructArray<contact::FadingForce>("fading");
  history.row_begin = View<int*>("row_begin", 3);
  history.row_count = View<int*>("row_count", 3);
  contact::LastContacts last{View<int*>("last_contact", 3)};
  setHistory(space, ids, records, true, atRow, history, last);
  const auto begin = toHost(history.row_begin), count = toHost(history.row_count);
  EXPECT_EQ(history.count, 4);
  EXPECT_EQ(count(0), 2);
  EXPECT_EQ(count(1), 0);
  EXPECT_EQ(count(2), 2);
  const auto pairs = toHost(history.interactions);
  for (const int row : {0, 2}) {
    EXPECT_LT(pairs(begin(row)).side, pairs(begin(row) + 1).side);
    EXPECT_EQ(pairs(begin(row)).node, row);
    EXPECT_EQ(pairs(begin(row)).point.node[0], row);
    EXPECT_EQ(pairs(begin(row)).point.node[1], row + 1);
  }
  const auto again = recordsOf(space, ids, history, last);
  ASSERT_EQ(again.size(), records.size());
  for (const auto& record : records) {
    bool is_found = false;
    for (const auto& other : again)
      is_found = is_found || valuesOf(record) == valuesOf(other);
    EXPECT_TRUE(is_found) << "node " << record.node << ", side " << record.pair.side;
  }
  records[0].node = 41;
  EXPECT_THROW(setHistory(space, ids, records, true, atRow, history, last), Error);
}

} // namespace
} // namespace brickwall::miniapp::testing
