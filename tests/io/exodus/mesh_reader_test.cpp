// Exodus meshes in: the same mesh on any number of ranks, and one error for each thing that can be
// wrong.
#include "tests/io/support/io_test_support.hpp"

#include "io/exodus/classic_netcdf.hpp"
#include "io/exodus/mesh_reader.hpp"
#include "io/exodus/mesh_writer.hpp"
#include "io/exodus/results_reader.hpp"
#include "io/mesh/redistribute.hpp"
#include "io/wall/wall_generator.hpp"

#include <exodusII.h>
#include <netcdf.h>

#include <sys/stat.h>

#include <fstream>

namespace brickwall::io::testing {
namespace {

WallConfig smallWall() {
  WallConfig config;
  config.bricks = {3, 1, 3};
  config.elements = {4, 2, 2};
  return config;
}

// Rank 0 writes `part` as one file; the others wait.
void writeAlone(const std::string& path, const WallConfig& wall, FileFormat format) {
  if (rankOf(MPI_COMM_WORLD) == 0) {
    ResultsConfig config;
    config.title = "wall";
    config.format = format;
    writeMesh(MPI_COMM_SELF, path, generateWall(MPI_COMM_SELF, wall), config);
  }
  MPI_Barrier(MPI_COMM_WORLD);
}

struct RawBlock {
  std::string kind;
  int corners; // per element
  std::vector<std::int64_t> nodes; // 1-based
};

// Rank 0 writes a mesh whose nodes are the corners of unit cubes along x, four to a plane, with
// blocks 10, 20, ... and one side set 5 and node set 6, all without names.
void writeRaw(const std::string& path, int num_nodes, const std::vector<RawBlock>& blocks,
              std::vector<std::int64_t> side_elems = {}, std::vector<std::int64_t> sides = {},
              std::vector<std::int64_t> set_nodes = {}) {
  if (rankOf(MPI_COMM_WORLD) == 0) {
    int real_bytes = 8, stored_bytes = 8;
    const int id = ex_create(path.c_str(), EX_CLOBBER | EX_64BIT_OFFSET | EX_ALL_INT64_API,
                             &real_bytes, &stored_bytes);
    ASSERT_GE(id, 0);
    std::int64_t num_elems = 0;
    for (const RawBlock& block : blocks)
      num_elems += static_cast<std::int64_t>(block.nodes.size()) / block.corners;
    ASSERT_EQ(ex_put_init(id, "raw", 3, num_nodes, num_elems,
                          static_cast<std::int64_t>(blocks.size()), 1, 1),
              0);
    std::vector<double> x, y, z;
    for (int node = 0; node < num_nodes; ++node) {
      x.push_back(node / 4);
      y.push_back(node % 4 == 1 || node % 4 == 2);
      z.push_back(node % 4 >= 2);
    }
    if (num_nodes > 0) {
      ASSERT_EQ(ex_put_coord(id, x.data(), y.data(), z.data()), 0);
    }
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const auto block_id = static_cast<std::int64_t>(10 * (b + 1));
      const RawBlock& block = blocks[b];
      ASSERT_EQ(ex_put_block(id, EX_ELEM_BLOCK, block_id, block.kind.c_str(),
                             static_cast<std::int64_t>(block.nodes.size()) / block.corners,
                             block.corners, 0, 0, 0),
                0);
      if (!block.nodes.empty()) {
        ASSERT_EQ(ex_put_conn(id, EX_ELEM_BLOCK, block_id, block.nodes.data(), nullptr, nullptr),
                  0);
      }
    }
    ASSERT_EQ(ex_put_set_param(id, EX_SIDE_SET, 5, static_cast<std::int64_t>(sides.size()), 0), 0);
    ASSERT_EQ(ex_put_set_param(id, EX_NODE_SET, 6, static_cast<std::int64_t>(set_nodes.size()), 0),
              0);
    if (!sides.empty()) {
      ASSERT_EQ(ex_put_set(id, EX_SIDE_SET, 5, side_elems.data(), sides.data()), 0);
    }
    if (!set_nodes.empty()) {
      ASSERT_EQ(ex_put_set(id, EX_NODE_SET, 6, set_nodes.data(), nullptr), 0);
    }
    ASSERT_EQ(ex_close(id), 0);
  }
  MPI_Barrier(MPI_COMM_WORLD);
}

// Nodes of the hex between plane p and p + 1, x being its third direction: any order that is a hex
// will do here.
std::vector<std::int64_t> cube(int plane) {
  std::vector<std::int64_t> nodes;
  for (int c = 0; c < 8; ++c)
    nodes.push_back(4 * plane + c + 1);
  return nodes;
}
RawBlock cubes(const std::vector<int>& planes) {
  RawBlock block{"HEX8", 8, {}};
  for (const int plane : planes)
    for (const std::int64_t node : cube(plane))
      block.nodes.push_back(node);
  return block;
}

void expectInputError(const std::string& path, const std::string& part_of_message) {
  const auto [code, message] = errorOf([&] { readMesh(MPI_COMM_WORLD, path); });
  EXPECT_EQ(code, ExitCode::bad_input);
  EXPECT_NE(message.find(path), std::string::npos) << message;
  EXPECT_NE(message.find(part_of_message), std::string::npos) << message;
}

TEST(MeshReader, ReadsBackWhatWasWrittenOnAnyNumberOfRanks) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  const WholeMesh wall = gatherMesh(MPI_COMM_SELF, generateWall(MPI_COMM_SELF, smallWall()));
  for (const FileFormat format : {FileFormat::offset64, FileFormat::netcdf4}) {
    const std::string path = folder / "wall.exo";
    writeAlone(path, smallWall(), format);
    const MeshPart part = readMesh(MPI_COMM_WORLD, path);
    expectConsistent(MPI_COMM_WORLD, part);
    EXPECT_TRUE(gatherMesh(MPI_COMM_WORLD, part) == wall);
    MPI_Barrier(MPI_COMM_WORLD);
  }
}

TEST(MeshReader, GivesTheSamePartsAsTheGenerator) {
  // The same centroids go into the same RCB: only their last bits may differ, and no cut of this
  // wall hangs on them.
  const TemporaryFolder folder(MPI_COMM_WORLD);
  writeAlone(folder / "wall.exo", smallWall(), FileFormat::offset64);
  const MeshPart part = readMesh(MPI_COMM_WORLD, folder / "wall.exo");
  const double share = static_cast<double>(part.num_global_elems) / sizeOf(MPI_COMM_WORLD);
  EXPECT_LE(part.numElems(), share + 3 * 4 * 2);
}

TEST(MeshReader, NumbersNodesInUseAndNamesWhatHasNoName) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  const std::string path = folder / "raw.exo";
  // Seven planes of nodes; elements use planes 1..2, 3..4 and 5..6: plane 0 and the set's node
  // there drop out.
  writeRaw(path, 28, {cubes({5, 1}), RawBlock{"TETRA", 4, {}}, cubes({3})}, {3, 1, 3, 1},
           {6, 2, 1, 2}, {28, 1, 5, 5, 28});
  const MeshPart part = readMesh(MPI_COMM_WORLD, path);
  expectConsistent(MPI_COMM_WORLD, part);
  const WholeMesh mesh = gatherMesh(MPI_COMM_WORLD, part);
  EXPECT_EQ(mesh.nodes.size(), 24u);
  EXPECT_EQ(mesh.nodes.at(0)[0], 1.0);
  EXPECT_EQ(mesh.nodes.at(23)[0], 6.0);
  ASSERT_EQ(mesh.elems.size(), 3u);
  EXPECT_EQ(mesh.elems.at(0).nodes[0], 16); // plane 5 of the file, plane 4 of those in use
  EXPECT_EQ(mesh.elems.at(1).nodes[0], 0);
  EXPECT_EQ(mesh.elems.at(2).block, 1);
  EXPECT_EQ(mesh.num_bodies, 3);
  for (const auto& [id, elem] : mesh.elems)
    EXPECT_EQ(elem.body, id);
  ASSERT_EQ(mesh.blocks.size(), 2u); // the empty one is dropped
  EXPECT_EQ(mesh.blocks[0].first, "block_10");
  EXPECT_EQ(mesh.blocks[1].first, "block_30");
  const std::set<std::pair<global_id, int>> sides = {{0, 1}, {2, 0}, {2, 5}};
  EXPECT_EQ(mesh.side_sets.at("side_set_5"), sides);
  const std::set<global_id> nodes = {0, 23};
  EXPECT_EQ(mesh.node_sets.at("node_set_6"), nodes);
}

TEST(MeshReader, FindsBodiesThatRanksCut) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  // One bar of eight cubes in reverse, and one of three.
  writeRaw(folder / "raw.exo", 4 * 14, {cubes({12, 7, 6, 5, 4}), cubes({3, 2, 10, 11, 1, 0})});
  const WholeMesh mesh = gatherMesh(MPI_COMM_WORLD, readMesh(MPI_COMM_WORLD, folder / "raw.exo"));
  EXPECT_EQ(mesh.num_bodies, 2);
  for (const auto& [id, elem] : mesh.elems)
    EXPECT_EQ(elem.body, id == 0 || id == 7 || id == 8 ? 0 : 1);
}

TEST(MeshReader, ReadsASingleElement) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  writeRaw(folder / "raw.exo", 8, {cubes({0})}, {1}, {5}, {1, 2, 3, 4});
  const MeshPart part = readMesh(MPI_COMM_WORLD, folder / "raw.exo");
  expectConsistent(MPI_COMM_WORLD, part);
  EXPECT_EQ(part.num_global_bodies, 1);
}

TEST(MeshReader, NamesAMissingFileAFolderAndAPipe) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  expectInputError(folder / "nothing.exo", "No such file");
  expectInputError(folder / ".", "folder");
  const std::string pipe = folder / "pipe"; // without a writer, reading it never ends
  if (rankOf(MPI_COMM_WORLD) == 0) {
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  expectInputError(pipe, "is a pipe or a device, not a mesh file");
}

TEST(MeshReader, RefusesWhatIsNotExodus) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  if (rankOf(MPI_COMM_WORLD) == 0) {
    std::ofstream(folder / "text.exo") << "this is not a mesh";
    std::ofstream(folder / "empty.exo");
  }
  MPI_Barrier(MPI_COMM_WORLD);
  expectInputError(folder / "text.exo", "not an Exodus file");
  expectInputError(folder / "empty.exo", "truncated");
}

TEST(MeshReader, RefusesATruncatedFileWhereverItEnds) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  for (const FileFormat format : {FileFormat::offset64, FileFormat::netcdf4}) {
    writeAlone(folder / "wall.exo", smallWall(), format);
    const auto bytes = static_cast<double>(std::filesystem::file_size(folder / "wall.exo"));
    for (const double part : {0.9999, 0.9, 0.5, 0.1, 0.01, 0.0001}) {
      if (rankOf(MPI_COMM_WORLD) == 0) {
        std::filesystem::copy_file(folder / "wall.exo", folder / "cut.exo",
                                   std::filesystem::copy_options::overwrite_existing);
        std::filesystem::resize_file(folder / "cut.exo", static_cast<std::uintmax_t>(part * bytes));
      }
      MPI_Barrier(MPI_COMM_WORLD);
      expectInputError(folder / "cut.exo", "");
      MPI_Barrier(MPI_COMM_WORLD);
    }
  }
}

TEST(MeshReader, KnowsTheSizeOfAnIntactClassicFile) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  writeAlone(folder / "wall.exo", smallWall(), FileFormat::offset64);
  const auto bytes = static_cast<std::int64_t>(std::filesystem::file_size(folder / "wall.exo"));
  const std::int64_t needed = classicFileBytes(folder / "wall.exo");
  EXPECT_LE(needed, bytes);
  EXPECT_GT(needed, bytes - 8); // but for padding
}

TEST(MeshReader, RefusesMeshesWithoutHexes) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  writeRaw(folder / "none.exo", 8, {});
  expectInputError(folder / "none.exo", "no hex8 block");
  writeRaw(folder / "empty.exo", 8, {RawBlock{"HEX8", 8, {}}});
  expectInputError(folder / "empty.exo", "no hex8 block with elements");
  writeRaw(folder / "tet.exo", 8, {RawBlock{"TETRA", 4, {1, 2, 3, 5}}});
  expectInputError(folder / "tet.exo", "block_10 is of type 'TETRA' with 4 nodes");
  writeRaw(folder / "mixed.exo", 8, {cubes({0}), RawBlock{"SHELL4", 4, {1, 2, 3, 4}}});
  expectInputError(folder / "mixed.exo", "block_20 is of type 'SHELL4'");
}

TEST(MeshReader, RefusesNumbersOutOfRange) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  writeRaw(folder / "node.exo", 7, {cubes({0})});
  expectInputError(folder / "node.exo", "a node of element 1 is 8");
  writeRaw(folder / "elem.exo", 8, {cubes({0})}, {2}, {1});
  expectInputError(folder / "elem.exo", "an element of side set side_set_5 is 2");
  writeRaw(folder / "side.exo", 8, {cubes({0})}, {1}, {7});
  expectInputError(folder / "side.exo", "a side of side set side_set_5 is 7");
  writeRaw(folder / "set.exo", 8, {cubes({0})}, {}, {}, {9});
  expectInputError(folder / "set.exo", "a node of node set node_set_6 is 9");
}

TEST(MeshReader, RefusesAnElementThatAppearsTwice) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  writeRaw(folder / "twice.exo", 24, {cubes({0, 2, 4}), cubes({2})});
  expectInputError(folder / "twice.exo",
                   "another element has the corners of the element of 1-based id 2 too");
}

TEST(MeshReader, RefusesIdsThatAppearTwice) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  const std::string path = folder / "twice.exo";
  writeRaw(path, 12, {cubes({0}), cubes({1})});
  if (rankOf(MPI_COMM_WORLD) == 0) {
    int file = -1, variable = -1;
    const int ids[2] = {10, 10};
    ASSERT_EQ(nc_open(path.c_str(), NC_WRITE, &file), 0);
    ASSERT_EQ(nc_inq_varid(file, "eb_prop1", &variable), 0);
    ASSERT_EQ(nc_put_var_int(file, variable, ids), 0);
    ASSERT_EQ(nc_close(file), 0);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  expectInputError(path, "the ids of blocks contain 10 twice");
}

TEST(MeshReader, ListsEmptyBlocksApart) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  writeRaw(folder / "empty.exo", 12, {cubes({0}), {"SHELL4", 4, {}}, cubes({1})});
  const MeshPart part = readMesh(MPI_COMM_WORLD, folder / "empty.exo");
  ASSERT_EQ(part.blocks.size(), 2u);
  EXPECT_EQ(part.blocks[1].id, 30);
  EXPECT_EQ(part.empty_blocks, std::vector<std::string>{"block_20"});
  const MeshPart moved = redistribute(MPI_COMM_WORLD, part, std::vector<int>(part.numElems(), 0));
  EXPECT_EQ(moved.empty_blocks, part.empty_blocks);
}

TEST(MeshReader, RefusesANodeAtTwoCornersOfAnElement) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  RawBlock block = cubes({0, 1});
  block.nodes[15] = block.nodes[14];
  writeRaw(folder / "wedge.exo", 12, {block});
  expectInputError(folder / "wedge.exo",
                   "the element of 1-based id 2 has node 11 at several corners");
}

TEST(MeshReader, RefusesAnotherNumberOfElementsThanTheBlocksHave) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  const std::string path = folder / "count.exo";
  if (rankOf(MPI_COMM_WORLD) == 0) {
    int real_bytes = 8, stored_bytes = 8;
    const int id =
        ex_create(path.c_str(), EX_CLOBBER | EX_ALL_INT64_API, &real_bytes, &stored_bytes);
    const std::vector<std::int64_t> corners = cube(0);
    EXPECT_EQ(ex_put_init(id, "count", 3, 8, 99, 1, 0, 0), 0);
    EXPECT_EQ(ex_put_block(id, EX_ELEM_BLOCK, 1, "HEX8", 1, 8, 0, 0, 0), 0);
    EXPECT_EQ(ex_put_conn(id, EX_ELEM_BLOCK, 1, corners.data(), nullptr, nullptr), 0);
    EXPECT_EQ(ex_close(id), 0);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  expectInputError(path, "found 99 for num_elem, expected the 1 elements of the blocks");
}

void putMap(const std::string& path, ex_entity_type type, const std::vector<std::int64_t>& ids) {
  if (rankOf(MPI_COMM_WORLD) == 0) {
    int real_bytes = 8, stored_bytes = 0;
    float version = 0;
    const int id =
        ex_open(path.c_str(), EX_WRITE | EX_ALL_INT64_API, &real_bytes, &stored_bytes, &version);
    EXPECT_GE(id, 0);
    EXPECT_EQ(ex_put_id_map(id, type, ids.data()), 0);
    EXPECT_EQ(ex_close(id), 0);
  }
  MPI_Barrier(MPI_COMM_WORLD);
}

// Nodes 17 to 24 of the file belong to no element, so that the global ids of those after them are
// not their places in it.
TEST(MeshReader, KeepsTheIdsOfTheMapsInResultsOfAnyPartition) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  const std::string path = folder / "ids.exo";
  writeRaw(path, 36, {cubes({0, 2}), cubes({6})});
  const std::vector<std::int64_t> of_elems = {900, 7, 2000000000};
  std::vector<std::int64_t> of_nodes(36);
  for (std::size_t i = 0; i < of_nodes.size(); ++i)
    of_nodes[i] = 1000 - 7 * static_cast<std::int64_t>(i);
  putMap(path, EX_ELEM_MAP, of_elems);
  putMap(path, EX_NODE_MAP, of_nodes);
  const MeshPart read = readMesh(MPI_COMM_WORLD, path);
  const int last = sizeOf(MPI_COMM_WORLD) - 1;
  for (const MeshPart& part :
       {read, redistribute(MPI_COMM_WORLD, read, std::vector<int>(read.elem_ids.size(), last))}) {
    writeMesh(MPI_COMM_WORLD, folder / "out.exo", part, {});
    const ResultsReader out(rankFileName(folder / "out.exo", last + 1, rankOf(MPI_COMM_WORLD)));
    ASSERT_EQ(out.elemNumbers().size(), part.elem_ids.size());
    for (std::size_t e = 0; e < part.elem_ids.size(); ++e)
      EXPECT_EQ(out.elemNumbers()[e], of_elems[static_cast<std::size_t>(part.elem_ids[e])]);
    ASSERT_EQ(out.nodeNumbers().size(), part.node_ids.size());
    for (std::size_t i = 0; i < part.node_ids.size(); ++i) {
      const auto place =
          static_cast<std::size_t>(part.node_ids[i] + (part.node_ids[i] < 16 ? 0 : 8));
      EXPECT_EQ(out.nodeNumbers()[i], of_nodes[place]);
    }
  }
}

TEST(MeshReader, RefusesMapsThatRepeatAnId) {
  const TemporaryFolder folder(MPI_COMM_WORLD);
  const auto withMap = [&](const char* name, ex_entity_type type,
                           const std::vector<std::int64_t>& ids) {
    std::string path = folder / name;
    writeRaw(path, 24, {cubes({0, 2, 4}), cubes({1})});
    putMap(path, type, ids);
    return path;
  };
  std::vector<std::int64_t> nodes(24);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    nodes[i] = 1000 - 7 * static_cast<std::int64_t>(i);
  const auto part = readMesh(MPI_COMM_WORLD, withMap("other.exo", EX_NODE_MAP, nodes));
  EXPECT_EQ(part.num_global_nodes, 24);
  nodes[22] = nodes[3];
  expectInputError(withMap("nodes.exo", EX_NODE_MAP, nodes),
                   "node_num_map: found the id 979 at nodes 4 and 23, expected every id once");
  expectInputError(withMap("elems.exo", EX_ELEM_MAP, {8, -5, 9, -5}),
                   "elem_num_map: found the id -5 at elements 2 and 4, expected every id once");
}

} // namespace
} // namespace brickwall::io::testing
