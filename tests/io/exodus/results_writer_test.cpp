// Results out: rank files that epu joins to the file of one rank, steps that survive, failures
// found at once.
#include "tests/io/support/io_test_support.hpp"

#include "io/exodus/mesh_reader.hpp"
#include "io/exodus/mesh_writer.hpp"
#include "io/exodus/results_writer.hpp"
#include "io/wall/wall_generator.hpp"

#include <exodusII.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <sstream>

namespace brickwall::io::testing {
namespace {

WallConfig wallOf(std::array<std::int64_t, 3> bricks, std::array<std::int64_t, 3> elements) {
  WallConfig config;
  config.bricks = bricks;
  config.elements = elements;
  return config;
}

ResultsConfig someFields() {
  ResultsConfig config;
  config.title = "Results of a test";
  config.version = "0.1.0";
  config.information = "title = \"x\"\n\n" + std::string(200, 'k') + "\nend = 0.03\n";
  config.nodal_names = {"displacement_x", "displacement_y", "displacement_z", "contact_status"};
  config.element_names = {"stress_xx", "energy_density"};
  config.global_names = {"kinetic_energy", "a_name_that_is_longer_than_the_classic_32_characters"};
  return config;
}

// Values that depend on global ids, variable and step alone.
double valueOf(std::int64_t id, int variable, int step) {
  return std::sin(0.7 * static_cast<double>(id) + variable) / (step + 3);
}

void writeSomeStep(ResultsWriter& writer, const MeshPart& part, const ResultsConfig& config,
                   int step) {
  std::vector<std::vector<double>> nodal(config.nodal_names.size()),
      element(config.element_names.size());
  for (std::size_t v = 0; v < nodal.size(); ++v)
    for (const global_id id : part.node_ids)
      nodal[v].push_back(valueOf(id, static_cast<int>(v), step));
  for (std::size_t v = 0; v < element.size(); ++v)
    for (const global_id id : part.elem_ids)
      element[v].push_back(valueOf(id, static_cast<int>(v) + 10, step));
  std::vector<double> global;
  for (std::size_t v = 0; v < config.global_names.size(); ++v)
    global.push_back(valueOf(static_cast<std::int64_t>(v), 20, step));
  writer.writeStep(0.1 * step, nodal, element, global);
}

void writeAll(MPI_Comm comm, const std::string& base, const MeshPart& part,
              const ResultsConfig& config, int num_steps) {
  ResultsWriter writer(comm, base, part, config);
  for (int step = 0; step < num_steps; ++step)
    writeSomeStep(writer, part, config, step);
  writer.close();
}

std::string contentsOf(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

// Runs a command of rank 0's, its output in a file; empty when it returns 0, else the output.
std::string complaintOf(const std::string& command, const std::string& log) {
  const int code = std::system((command + " > " + log + " 2>&1").c_str());
  return code == 0 ? "" : command + " returned " + std::to_string(code) + "\n" + contentsOf(log);
}

// An Exodus file that is open for reading while this lives.
class OpenFile {
public:
  explicit OpenFile(const std::string& path) {
    int real_bytes = 8, stored_bytes = 0;
    float version = 0;
    _id = ex_open(path.c_str(), EX_READ | EX_ALL_INT64_API, &real_bytes, &stored_bytes, &version);
  }
  ~OpenFile() { ex_close(_id); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  operator int() const { return _id; } // negative if it cannot be opened

private:
  int _id;
};

// Every entry of every set. Node sets in the order of the file; epu appends side sets file by file,
// so they are sorted.
std::string listSets(const std::string& path) {
  const OpenFile id(path);
  if (id < 0)
    return "cannot be opened: " + path;
  std::ostringstream text;
  for (const ex_entity_type type : {EX_SIDE_SET, EX_NODE_SET}) {
    const auto count = static_cast<std::size_t>(
        ex_inquire_int(id, type == EX_SIDE_SET ? EX_INQ_SIDE_SETS : EX_INQ_NODE_SETS));
    std::vector<std::int64_t> ids(count);
    if (count > 0)
      ex_get_ids(id, type, ids.data());
    for (const std::int64_t set : ids) {
      std::int64_t entries = 0, factors = 0;
      char name[257] = {};
      ex_get_set_param(id, type, set, &entries, &factors);
      ex_get_name(id, type, set, name);
      text << name << ":";
      std::vector<std::int64_t> list(static_cast<std::size_t>(entries)), sides(list.size());
      if (entries > 0)
        ex_get_set(id, type, set, list.data(), type == EX_SIDE_SET ? sides.data() : nullptr);
      std::vector<std::pair<std::int64_t, std::int64_t>> pairs;
      for (std::size_t i = 0; i < list.size(); ++i)
        pairs.emplace_back(list[i], sides[i]);
      if (type == EX_SIDE_SET)
        std::sort(pairs.begin(), pairs.end());
      for (const auto& [entry, side] : pairs)
        text << " " << entry << "/" << side;
      text << "\n";
    }
  }
  return text.str();
}

// Writes `part` on all ranks as "many.exo" and the wall on rank 0 as "alone.exo", some steps each.
void writeBoth(const TemporaryFolder& folder, const WallConfig& wall, const MeshPart& part,
               const ResultsConfig& config, int num_steps) {
  writeAll(MPI_COMM_WORLD, folder / "many.exo", part, config, num_steps);
  if (rankOf(MPI_COMM_WORLD) == 0)
    writeAll(MPI_COMM_SELF, folder / "alone.exo", generateWall(MPI_COMM_SELF, wall), config,
             num_steps);
}

// Joins rank files with epu, which writes into the current folder, and compares with the file that
// rank 0 wrote alone.
void expectJoinedEqual(const TemporaryFolder& folder, const std::string& base,
                       const std::string& alone) {
  MPI_Barrier(MPI_COMM_WORLD);
  if (rankOf(MPI_COMM_WORLD) == 0) {
    const int size = sizeOf(MPI_COMM_WORLD);
    const std::string in_folder = "cd " + (folder / ".") + " && ", log = folder / "log";
    if (size > 1) {
      EXPECT_EQ(
          complaintOf(in_folder + BRICKWALL_EPU + " -auto " + rankFileName(base, size, 0), log),
          "");
    }
    EXPECT_EQ(
        complaintOf(in_folder + BRICKWALL_EXODIFF + " -tolerance 0 -Floor 0 " + base + " " + alone,
                    log),
        "");
    EXPECT_TRUE(listSets(folder / base) == listSets(folder / alone));
  }
  MPI_Barrier(MPI_COMM_WORLD);
}

TEST(RankFileName, PadsTheRankToTheWidthOfTheCount) {
  EXPECT_EQ(rankFileName("a.exo", 1, 0), "a.exo");
  EXPECT_EQ(rankFileName("a.exo", 8, 3), "a.exo.8.3");
  EXPECT_EQ(rankFileName("a.exo", 128, 7), "a.exo.128.007");
}

TEST(ResultsWriter, RankFilesJoinToTheFileOfOneRank) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  const WallConfig wall = wallOf({3, 1, 4}, {4, 2, 2});
  const MeshPart part = generateWall(MPI_COMM_WORLD, wall);
  for (const FileFormat format : {FileFormat::offset64, FileFormat::netcdf4}) {
    for (const bool single : {false, true}) {
      ResultsConfig config = someFields();
      config.format = format;
      config.single_precision = single;
      writeBoth(folder, wall, part, config, 3);
      expectJoinedEqual(folder, "many.exo", "alone.exo");
    }
  }
}

TEST(ResultsWriter, RanksWithoutElementsJoinToo) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  for (const WallConfig& wall : {wallOf({1, 1, 1}, {1, 1, 1}), wallOf({1, 1, 2}, {2, 1, 1})}) {
    writeBoth(folder, wall, generateWall(MPI_COMM_WORLD, wall), someFields(), 2);
    expectJoinedEqual(folder, "many.exo", "alone.exo");
  }
}

TEST(MeshWriter, WritesAMeshThatReadsBackAfterJoining) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  const WallConfig wall = wallOf({3, 1, 3}, {4, 2, 2});
  const MeshPart part = generateWall(MPI_COMM_WORLD, wall);
  ResultsConfig config;
  config.title = "mesh only";
  writeMesh(MPI_COMM_WORLD, folder / "mesh.exo", part, config);
  if (rankOf(MPI_COMM_WORLD) == 0)
    writeMesh(MPI_COMM_SELF, folder / "alone.exo", generateWall(MPI_COMM_SELF, wall), config);
  expectJoinedEqual(folder, "mesh.exo", "alone.exo");
  const MeshPart again = readMesh(MPI_COMM_WORLD, folder / "mesh.exo");
  EXPECT_TRUE(gatherMesh(MPI_COMM_WORLD, again) == gatherMesh(MPI_COMM_WORLD, part));
}

TEST(ResultsWriter, JoinsAMeshReadFromAFile) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  const WallConfig wall = wallOf({3, 1, 3}, {4, 2, 2});
  if (rankOf(MPI_COMM_WORLD) == 0)
    writeMesh(MPI_COMM_SELF, folder / "mesh.exo", generateWall(MPI_COMM_SELF, wall), {});
  MPI_Barrier(MPI_COMM_WORLD);
  writeBoth(folder, wall, readMesh(MPI_COMM_WORLD, folder / "mesh.exo"), someFields(), 2);
  expectJoinedEqual(folder, "many.exo", "alone.exo");
}

TEST(ResultsWriter, StepsAreReadableWhileTheFileIsStillOpen) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  const ResultsConfig config = someFields();
  for (const FileFormat format : {FileFormat::offset64, FileFormat::netcdf4}) {
    ResultsConfig of_format = config;
    of_format.format = format;
    const MeshPart part = generateWall(MPI_COMM_WORLD, wallOf({2, 1, 2}, {2, 2, 2}));
    ResultsWriter writer(MPI_COMM_WORLD, folder / "open.exo", part, of_format);
    writeSomeStep(writer, part, config, 0);
    writeSomeStep(writer, part, config, 1);
    EXPECT_EQ(writer.numSteps(), 2);
    // A copy is what a killed run leaves behind.
    const std::string copy = writer.fileName() + ".copy";
    std::filesystem::copy_file(writer.fileName(), copy,
                               std::filesystem::copy_options::overwrite_existing);
    const OpenFile id(copy);
    ASSERT_GE(id, 0);
    EXPECT_EQ(ex_inquire_int(id, EX_INQ_TIME), 2);
    double time = 0;
    EXPECT_EQ(ex_get_time(id, 2, &time), 0);
    EXPECT_EQ(time, 0.1);
    if (part.numNodes() > 0) {
      std::vector<double> values(part.node_ids.size());
      EXPECT_EQ(ex_get_var(id, 2, EX_NODAL, 3, 1, part.numNodes(), values.data()), 0);
      for (std::size_t node = 0; node < values.size(); ++node)
        EXPECT_EQ(values[node], valueOf(part.node_ids[node], 2, 1));
    }
    std::vector<double> global(2);
    EXPECT_EQ(ex_get_var(id, 2, EX_GLOBAL, 1, 1, 2, global.data()), 0);
    EXPECT_EQ(global[1], valueOf(1, 20, 1));
    std::filesystem::remove(copy);
    MPI_Barrier(MPI_COMM_WORLD);
  }
}

TEST(ResultsWriter, CarriesNamesInformationAndBrickNumbers) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  const ResultsConfig config = someFields();
  const MeshPart part = generateWall(MPI_COMM_WORLD, wallOf({2, 1, 2}, {2, 2, 2}));
  writeAll(MPI_COMM_WORLD, folder / "named.exo", part, config, 1);
  const std::string path =
      rankFileName(folder / "named.exo", sizeOf(MPI_COMM_WORLD), rankOf(MPI_COMM_WORLD));
  const OpenFile id(path);
  ASSERT_GE(id, 0);
  ex_set_max_name_length(id, 128);
  char name[129] = {};
  ASSERT_EQ(ex_get_variable_name(id, EX_GLOBAL, 2, name), 0);
  EXPECT_EQ(std::string(name), config.global_names[1]);
  ASSERT_EQ(ex_get_variable_name(id, EX_ELEM_BLOCK, 3, name), 0);
  EXPECT_EQ(std::string(name), "brick_id");
  const auto lines = static_cast<std::size_t>(ex_inquire_int(id, EX_INQ_INFO));
  EXPECT_EQ(lines, 6u); // title, empty, 80 + 80 + 40 characters, end
  std::vector<std::vector<char>> text(lines, std::vector<char>(MAX_LINE_LENGTH + 1));
  std::vector<char*> pointers;
  for (auto& line : text)
    pointers.push_back(line.data());
  ASSERT_EQ(ex_get_info(id, pointers.data()), 0);
  EXPECT_EQ(std::string(text[5].data()), "end = 0.03");
  EXPECT_EQ(std::string(text[4].data()), std::string(40, 'k'));
  const int num_bricks =
      static_cast<int>(std::count(part.elem_block.begin(), part.elem_block.end(), 0));
  if (num_bricks > 0) {
    std::vector<double> bricks(num_bricks);
    ASSERT_EQ(ex_get_var(id, 1, EX_ELEM_BLOCK, 3, 1, num_bricks, bricks.data()), 0);
    for (int elem = 0; elem < num_bricks; ++elem)
      EXPECT_EQ(bricks[elem], static_cast<double>(part.elem_body[elem] + 1));
  }
}

TEST(ResultsWriter, SaysOnAllRanksThatAFileCannotBeCreated) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  const MeshPart part = generateWall(MPI_COMM_WORLD, wallOf({1, 1, 1}, {2, 2, 2}));
  const auto [code, message] = errorOf([&] {
    ResultsWriter writer(MPI_COMM_WORLD, folder / "missing/results.exo", part, someFields());
  });
  EXPECT_EQ(code, ExitCode::output);
  EXPECT_NE(message.find("missing/results.exo"), std::string::npos) << message;
}

// Files of this process end at `bytes` while this lives, as on a full disk: writes beyond fail with
// EFBIG.
class FileSizeLimit {
public:
  explicit FileSizeLimit(rlim_t bytes) : _handler(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &_old);
    const rlimit limit{bytes, _old.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &_old);
    std::signal(SIGXFSZ, _handler);
  }

private:
  void (*_handler)(int);
  rlimit _old{};
};

TEST(ResultsWriter, FindsAFullDiskInTheStepOnAllRanks) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  const MeshPart part = generateWall(MPI_COMM_WORLD, wallOf({4, 1, 4}, {4, 4, 4}));
  const int last = sizeOf(MPI_COMM_WORLD) - 1;
  for (const FileFormat format : {FileFormat::offset64, FileFormat::netcdf4}) {
    ResultsConfig config = someFields();
    config.format = format;
    ResultsWriter writer(MPI_COMM_WORLD, folder / "full.exo", part, config);
    writeSomeStep(writer, part, config, 0);
    const auto bytes = std::filesystem::file_size(writer.fileName());
    std::pair<ExitCode, std::string> error;
    {
      // Only one rank's disk is full.
      const FileSizeLimit limit(rankOf(MPI_COMM_WORLD) == last ? bytes + 64 : RLIM_INFINITY);
      error = errorOf([&] { writeSomeStep(writer, part, config, 1); });
    }
    EXPECT_EQ(error.first, ExitCode::output) << error.second;
    EXPECT_NE(error.second.find("full.exo"), std::string::npos) << error.second;
    EXPECT_NE(error.second.find("step 2"), std::string::npos) << error.second;
  }
}

TEST(ResultsWriter, FindsAFullDiskWhenTheMeshIsWritten) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  const MeshPart part = generateWall(MPI_COMM_WORLD, wallOf({4, 1, 4}, {4, 4, 4}));
  for (const FileFormat format : {FileFormat::offset64, FileFormat::netcdf4}) {
    ResultsConfig config = someFields();
    config.format = format;
    std::pair<ExitCode, std::string> error;
    {
      const FileSizeLimit limit(rankOf(MPI_COMM_WORLD) == 0 ? 4096 : RLIM_INFINITY);
      error = errorOf([&] { writeMesh(MPI_COMM_WORLD, folder / "full.exo", part, config); });
    }
    EXPECT_EQ(error.first, ExitCode::output) << error.second;
  }
}

TEST(ResultsWriter, WritesIdsBeyond32Bits) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  if (rankOf(MPI_COMM_WORLD) == 0) {
    MeshPart part = generateWall(MPI_COMM_SELF, wallOf({1, 1, 1}, {2, 1, 1}));
    const global_id shift = global_id(1) << 40;
    for (auto* ids : {&part.elem_ids, &part.node_ids})
      for (global_id& id : *ids)
        id += shift;
    part.num_global_elems += shift;
    part.num_global_nodes += shift;
    writeMesh(MPI_COMM_SELF, folder / "large.exo", part, {});
    const OpenFile id(folder / "large.exo");
    std::vector<global_id> ids(part.elem_ids.size());
    EXPECT_EQ(ex_get_id_map(id, EX_ELEM_MAP, ids.data()), 0);
    EXPECT_EQ(ids.back(), part.elem_ids.back() + 1);
  }
  MPI_Barrier(MPI_COMM_WORLD);
}

TEST(ResultsWriter, WritesIdsOfBlocksAndSetsBeyond32Bits) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  for (const ex_entity_type type : {EX_ELEM_BLOCK, EX_SIDE_SET, EX_NODE_SET}) {
    MeshPart part = generateWall(MPI_COMM_WORLD, wallOf({2, 1, 2}, {2, 2, 2}));
    (type == EX_ELEM_BLOCK ? part.blocks[0].id
     : type == EX_SIDE_SET ? part.side_sets[0].id
                           : part.node_sets[0].id) = std::int64_t(1) << 40;
    writeMesh(MPI_COMM_WORLD, folder / "large.exo", part, {});
    const OpenFile file(
        rankFileName(folder / "large.exo", sizeOf(MPI_COMM_WORLD), rankOf(MPI_COMM_WORLD)));
    std::vector<std::int64_t> ids(part.side_sets.size() + part.node_sets.size() + 1);
    EXPECT_EQ(ex_get_ids(file, type, ids.data()), 0);
    EXPECT_EQ(ids[0], std::int64_t(1) << 40);
  }
}

TEST(ResultsWriter, DemandsOneValueForEachNodeAndElement) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  const MeshPart part = generateWall(MPI_COMM_WORLD, wallOf({1, 1, 1}, {2, 2, 2}));
  ResultsConfig config;
  config.nodal_names = {"contact_gap"};
  ResultsWriter writer(MPI_COMM_WORLD, folder / "sizes.exo", part, config);
  EXPECT_EQ(errorOf([&] { writer.writeStep(0, {}, {}, {}); }).first, ExitCode::internal);
  EXPECT_EQ(errorOf([&] {
              writer.writeStep(0, {std::vector<double>(part.node_ids.size() + 1)}, {}, {});
            }).first,
            ExitCode::internal);
}

} // namespace
} // namespace brickwall::io::testing
