// Table files: the same bits back, empty tables, damage; rows that find the ranks of another
// partition.
#include "io/checkpoint/table_file.hpp"
#include "io/mesh/rows_by_id.hpp"
#include "tests/io/support/io_test_support.hpp"

#include <cmath>
#include <fstream>

namespace brickwall::io::testing {
namespace {

std::string fileOf(const TemporaryFolder& folder) {
  return folder / ("tables." + std::to_string(rankOf(MPI_COMM_WORLD)) + ".nc");
}

std::vector<Table> someTables() {
  return {{"run",
           {{"time", true, 1, {wordOf(0.1)}}, {"list", false, 3, {1, -2, std::int64_t(1) << 62}}}},
          {"nodes",
           {{"id", false, 1, {7, 9}},
            {"velocity",
             true,
             3,
             {wordOf(-0.0), wordOf(1e-310), wordOf(NAN), wordOf(HUGE_VAL), wordOf(2), wordOf(3)}}}},
          {"node_contacts", {{"id", false, 1, {}}, {"normal", true, 3, {}}}}};
}

TEST(TableFile, ReturnsTheBitsThatWereWritten) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  const auto written = someTables();
  writeTables(fileOf(folder), written);
  const auto read = readTables(fileOf(folder));
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t t = 0; t < read.size(); ++t) {
    EXPECT_EQ(read[t].name, written[t].name);
    ASSERT_EQ(read[t].columns.size(), written[t].columns.size());
    for (std::size_t c = 0; c < read[t].columns.size(); ++c) {
      const Column &one = read[t].columns[c], &other = written[t].columns[c];
      EXPECT_EQ(one.name, other.name);
      EXPECT_EQ(one.is_real, other.is_real);
      EXPECT_EQ(one.width, other.width);
      EXPECT_EQ(one.words, other.words);
    }
  }
  EXPECT_THROW(read[0].column("nothing"), InputError);
}

TEST(TableFile, HasAChecksumOfEachByte) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  writeTables(fileOf(folder), someTables());
  const std::uint64_t before = fileChecksum(fileOf(folder));
  EXPECT_EQ(fileChecksum(fileOf(folder)), before);
  std::fstream file(fileOf(folder), std::ios::in | std::ios::out | std::ios::binary);
  file.seekg(0, std::ios::end);
  const std::int64_t length = file.tellg();
  for (const std::int64_t at : {std::int64_t(0), length / 2, length - 1}) {
    file.seekg(at);
    const char byte = static_cast<char>(file.get());
    file.seekp(at);
    file.put(static_cast<char>(byte ^ 1)).flush();
    EXPECT_NE(fileChecksum(fileOf(folder)), before) << "byte " << at;
    file.seekp(at);
    file.put(byte).flush();
  }
  EXPECT_EQ(fileChecksum(fileOf(folder)), before);
  file.seekp(0, std::ios::end);
  file.put('\0').flush(); // a longer file with the same words
  EXPECT_NE(fileChecksum(fileOf(folder)), before);
}

TEST(TableFile, NamesAFileThatCannotBeWrittenOrRead) {
  EXPECT_THROW(writeTables("/dev/null/x.nc", someTables()), OutputError);
  EXPECT_THROW(readTables("/dev/null/x.nc"), InputError);
  EXPECT_THROW(fileChecksum("/nowhere/x.nc"), InputError);
  EXPECT_THROW(syncToDisk("/nowhere/x.nc"), OutputError);
}

// Rank r holds the ids that are r modulo the number of ranks, each as often as its last digit says;
// every rank wants all of them, backwards, and some that do not exist.
TEST(RowsById, FindTheRanksThatWantThem) {
  const int size = sizeOf(MPI_COMM_WORLD), rank = rankOf(MPI_COMM_WORLD);
  constexpr global_id num_ids = 53;
  RowsById held;
  held.width = 2;
  for (global_id id = rank; id < num_ids; id += size)
    for (global_id copy = 0; copy < id % 4; ++copy) {
      held.ids.push_back(id);
      held.words.insert(held.words.end(), {id * id, copy});
    }
  std::vector<global_id> wanted;
  for (global_id id = num_ids + 5; id >= 0; --id)
    wanted.push_back(id);
  const RowsById found = fetchRows(MPI_COMM_WORLD, held, wanted);
  std::size_t row = 0;
  for (const global_id id : wanted)
    for (global_id copy = 0; copy < (id < num_ids ? id % 4 : 0); ++copy, ++row) {
      ASSERT_LT(row, found.ids.size());
      EXPECT_EQ(found.ids[row], id);
      EXPECT_EQ(found.row(row)[0], id * id);
      EXPECT_EQ(found.row(row)[1], copy);
    }
  EXPECT_EQ(row, found.ids.size());
}

} // namespace
} // namespace brickwall::io::testing
