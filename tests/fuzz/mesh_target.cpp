// The Exodus reader on valid files of meshes that may be wrong: the bytes of the input choose a
// grid of cubes in up to three blocks, its sets, and faults: corners, sides and nodes out of range,
// elements that appear twice or have a node twice, coordinates that are not finite, odd names,
// kinds of elements and dimensions. A mesh is accepted if and only if this target finds nothing
// wrong with it, and is then the mesh that was written.
#include "tests/fuzz/mesh_properties.hpp"

#include <exodusII.h>

#include <array>
#include <limits>

namespace {

using namespace brickwall;
using fuzz::Choices;
using fuzz::demand;

struct RawBlock {
  std::string kind = "HEX8", name;
  int corners = 8; // per element
  std::vector<std::int64_t> nodes; // 1-based
  std::int64_t numElems() const { return static_cast<std::int64_t>(nodes.size()) / corners; }
};
struct RawSet {
  std::string name;
  std::vector<std::int64_t> entries, sides; // 1-based; no sides: a node set
};
struct RawMesh {
  int dimensions = 3;
  bool is_netcdf4 = false;
  std::array<std::vector<double>, 3> x;
  std::vector<RawBlock> blocks;
  std::vector<RawSet> side_sets, node_sets;

  std::int64_t numNodes() const { return static_cast<std::int64_t>(x[0].size()); }
  std::int64_t numElems() const {
    std::int64_t sum = 0;
    for (const RawBlock& block : blocks)
      sum += block.numElems();
    return sum;
  }
};

std::int64_t oddInteger(Choices& choices, std::int64_t limit) {
  const std::int64_t odd[] = {0,
                              -1,
                              1,
                              limit,
                              limit + 1,
                              2147483647,
                              -2147483648ll,
                              7,
                              std::numeric_limits<std::int64_t>::max(),
                              std::numeric_limits<std::int64_t>::min()};
  return odd[choices.below(std::size(odd))];
}
double oddReal(Choices& choices) {
  const double odd[] = {NAN, HUGE_VAL, -HUGE_VAL, 1e308, -1e308, 5e-324, -0.0, 0, 1};
  return odd[choices.below(std::size(odd))];
}
std::string oddName(Choices& choices) {
  const std::string odd[] = {"brick",
                             "",
                             " ",
                             "a b",
                             "\x1b[31m",
                             "\xff\xfe",
                             std::string(32, 'n'),
                             std::string(33, 'n'),
                             std::string(256, 'n'),
                             "block_1",
                             "%s%n"};
  return odd[choices.below(std::size(odd))];
}

RawMesh grid(Choices& choices) {
  RawMesh mesh;
  mesh.is_netcdf4 = choices.below(4) == 3;
  const auto nx = static_cast<std::int64_t>(1 + choices.below(4)),
             ny = static_cast<std::int64_t>(1 + choices.below(2));
  for (std::int64_t k = 0; k < 2; ++k)
    for (std::int64_t j = 0; j <= ny; ++j)
      for (std::int64_t i = 0; i <= nx; ++i) {
        mesh.x[0].push_back(static_cast<double>(i));
        mesh.x[1].push_back(static_cast<double>(j));
        mesh.x[2].push_back(static_cast<double>(k));
      }
  mesh.blocks.resize(1 + choices.below(3));
  for (std::int64_t j = 0; j < ny; ++j)
    for (std::int64_t i = 0; i < nx; ++i) {
      const std::int64_t layer = (nx + 1) * (ny + 1), first = 1 + i + (nx + 1) * j;
      auto& nodes = mesh.blocks[choices.below(mesh.blocks.size())].nodes;
      for (const std::int64_t below : {first, first + layer})
        nodes.insert(nodes.end(), {below, below + 1, below + nx + 2, below + nx + 1});
    }
  mesh.side_sets.resize(choices.below(3));
  for (RawSet& set : mesh.side_sets)
    for (std::size_t i = choices.below(5); i > 0; --i) {
      set.entries.push_back(
          1 + static_cast<std::int64_t>(choices.below(static_cast<std::size_t>(mesh.numElems()))));
      set.sides.push_back(1 + static_cast<std::int64_t>(choices.below(6)));
    }
  mesh.node_sets.resize(choices.below(3));
  for (RawSet& set : mesh.node_sets)
    for (std::size_t i = choices.below(5); i > 0; --i)
      set.entries.push_back(
          1 + static_cast<std::int64_t>(choices.below(static_cast<std::size_t>(mesh.numNodes()))));
  return mesh;
}

template <class T>
T* one(std::vector<T>& of, Choices& choices) {
  return of.empty() ? nullptr : &of[choices.below(of.size())];
}

void damage(RawMesh& mesh, Choices& choices) {
  RawBlock& block = *one(mesh.blocks, choices);
  RawSet* const side_set = one(mesh.side_sets, choices);
  RawSet* const node_set = one(mesh.node_sets, choices);
  switch (choices.below(10)) {
  case 0:
    if (auto* node = one(block.nodes, choices))
      *node = oddInteger(choices, mesh.numNodes());
    break;
  case 1:
    mesh.x[choices.below(3)][choices.below(mesh.x[0].size())] = oddReal(choices);
    break;
  case 2:
    if (auto* elem = side_set ? one(side_set->entries, choices) : nullptr)
      *elem = oddInteger(choices, mesh.numElems());
    break;
  case 3:
    if (auto* side = side_set ? one(side_set->sides, choices) : nullptr)
      *side = oddInteger(choices, 6);
    break;
  case 4:
    if (auto* node = node_set ? one(node_set->entries, choices) : nullptr)
      *node = oddInteger(choices, mesh.numNodes());
    break;
  case 5:
    (side_set && choices.below(2) ? side_set->name
     : node_set                   ? node_set->name
                                  : block.name) = oddName(choices);
    break;
  case 6: {
    static const char* const kinds[] = {"HEX", "hex8", "TETRA", "SHELL4", "HEX27", "", "NFACED"};
    block.kind = kinds[choices.below(std::size(kinds))];
    break;
  }
  case 7: // an element twice
    if (block.corners == 8 && !block.nodes.empty()) {
      const std::vector<std::int64_t> first(block.nodes.begin(), block.nodes.begin() + 8);
      block.nodes.insert(block.nodes.end(), first.begin(), first.end());
    }
    break;
  case 8:
    block.corners = choices.below(2) ? 4 : 1;
    break;
  default:
    mesh.dimensions = 1 + static_cast<int>(choices.below(3));
  }
}

bool isLegal(const RawMesh& mesh) {
  const auto within = [](const std::vector<std::int64_t>& list, std::int64_t limit) {
    return std::all_of(list.begin(), list.end(), [&](auto i) { return i >= 1 && i <= limit; });
  };
  bool has_elems = false;
  std::set<std::set<std::int64_t>> elems;
  for (const RawBlock& block : mesh.blocks) {
    if (block.nodes.empty())
      continue;
    has_elems = true;
    const bool is_hex = block.kind == "HEX" || block.kind == "HEX8" || block.kind == "hex8" ||
                        block.kind == "HEX27"; // which says less than the number of corners
    if (!is_hex || block.corners != 8 || !within(block.nodes, mesh.numNodes()))
      return false;
    for (auto node = block.nodes.begin(); node != block.nodes.end(); node += 8) {
      const std::set<std::int64_t> corners(node, node + 8);
      if (corners.size() < 8 || !elems.insert(corners).second)
        return false;
    }
  }
  for (const auto& component : mesh.x)
    for (const double x : component)
      if (!std::isfinite(x))
        return false;
  for (const RawSet& set : mesh.side_sets)
    if (!within(set.entries, mesh.numElems()) || !within(set.sides, 6))
      return false;
  for (const RawSet& set : mesh.node_sets)
    if (!within(set.entries, mesh.numNodes()))
      return false;
  return has_elems && mesh.dimensions == 3;
}

// Whether Exodus could write it.
bool write(const std::string& path, const RawMesh& mesh) {
  ex_opts(0);
  int real_bytes = 8, stored_bytes = 8;
  const int format = mesh.is_netcdf4 ? EX_NETCDF4 | EX_ALL_INT64_DB : EX_64BIT_OFFSET;
  const int id =
      ex_create(path.c_str(), EX_CLOBBER | format | EX_ALL_INT64_API, &real_bytes, &stored_bytes);
  bool good = id >= 0 && ex_set_max_name_length(id, 256) >= 0;
  const auto count = [](const auto& list) { return static_cast<std::int64_t>(list.size()); };
  good = good && ex_put_init(id, "fuzz", mesh.dimensions, mesh.numNodes(), mesh.numElems(),
                             count(mesh.blocks), count(mesh.node_sets), count(mesh.side_sets)) >= 0;
  good = good && ex_put_coord(id, mesh.x[0].data(), mesh.x[1].data(), mesh.x[2].data()) >= 0;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const RawBlock& block = mesh.blocks[b];
    const auto number = static_cast<std::int64_t>(10 + b);
    good = good && ex_put_block(id, EX_ELEM_BLOCK, number, block.kind.c_str(), block.numElems(),
                                block.corners, 0, 0, 0) >= 0;
    if (!block.nodes.empty())
      good =
          good && ex_put_conn(id, EX_ELEM_BLOCK, number, block.nodes.data(), nullptr, nullptr) >= 0;
    if (!block.name.empty())
      good = good && ex_put_name(id, EX_ELEM_BLOCK, number, block.name.c_str()) >= 0;
  }
  const auto putSets = [&](ex_entity_type type, const std::vector<RawSet>& sets) {
    for (std::size_t s = 0; s < sets.size(); ++s) {
      const RawSet& set = sets[s];
      const auto number = static_cast<std::int64_t>(20 + s);
      good = good && ex_put_set_param(id, type, number, count(set.entries), 0) >= 0;
      if (!set.entries.empty())
        good = good && ex_put_set(id, type, number, set.entries.data(),
                                  set.sides.empty() ? nullptr : set.sides.data()) >= 0;
      if (!set.name.empty())
        good = good && ex_put_name(id, type, number, set.name.c_str()) >= 0;
    }
  };
  putSets(EX_SIDE_SET, mesh.side_sets);
  putSets(EX_NODE_SET, mesh.node_sets);
  return id >= 0 && ex_close(id) >= 0 && good;
}

void demandWhatWasWritten(const RawMesh& mesh, const io::MeshPart& part) {
  std::size_t corner = 0;
  for (const RawBlock& block : mesh.blocks)
    for (const std::int64_t node : block.nodes) {
      const int local = part.elem_nodes[corner++];
      for (std::size_t d = 0; d < 3; ++d)
        demand(part.coordinates[3 * static_cast<std::size_t>(local) + d] ==
                   mesh.x[d][static_cast<std::size_t>(node - 1)],
               "corners stand where they were written");
    }
  demand(corner == part.elem_nodes.size(), "all elements are there");
  demand(part.side_sets.size() == mesh.side_sets.size(), "all side sets are there");
  for (std::size_t s = 0; s < mesh.side_sets.size(); ++s) {
    std::set<std::pair<std::int64_t, std::int64_t>> sides, expected;
    for (std::size_t i = 0; i < part.side_sets[s].elems.size(); ++i)
      sides.emplace(part.side_sets[s].elems[i] + 1, part.side_sets[s].sides[i] + 1);
    for (std::size_t i = 0; i < mesh.side_sets[s].entries.size(); ++i)
      expected.emplace(mesh.side_sets[s].entries[i], mesh.side_sets[s].sides[i]);
    demand(sides == expected, "sides are those that were written");
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = fuzz::folder() / "mesh.exo";
  Choices choices(data, size);
  RawMesh mesh = grid(choices);
  for (int i = 0; i < 8 && choices.any(); ++i)
    damage(mesh, choices);
  if (!write(path, mesh))
    return 0;
  const auto part = fuzz::readOrRefuse(path);
  demand(part.has_value() == isLegal(mesh), isLegal(mesh) ? "accepted" : "refused");
  if (!part)
    return 0;
  fuzz::demandSound(*part);
  demandWhatWasWritten(mesh, *part);
  fuzz::demandSameWhenWritten(*part);
  return 0;
}
