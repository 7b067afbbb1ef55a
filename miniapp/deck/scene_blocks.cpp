// title, [wall], [mesh], [material.<name>], [element]
#include "miniapp/deck/block_keys.hpp"
#include "miniapp/deck/deck_blocks.hpp"

#include <algorithm>
#include <filesystem>

namespace brickwall::miniapp {
namespace {

using io::BlockKind;
using io::Deck;

void topKeys(BlockKeys& keys, Config& config) {
  keys.add("title", config.title, "one line about the problem; it stands in reports and results");
  keys.add("units", config.units,
           "units of length, mass and time for the labels of reports and pictures; nothing is "
           "converted");
}

void wallKeys(BlockKeys& keys, WallConfig& wall) {
  keys.add("bricks", wall.bricks,
           "numbers of bricks along the wall (x) and across it (y), number of courses (z)")
      .mustBeGiven()
      .atLeast(1)
      .atMost(1e6);
  keys.add("brick", wall.brick, "size of a brick in x, y and z").in("m").mustBeGiven().above(0);
  keys.add("elements", wall.elements,
           "elements of a brick in x, y and z; an even number in x where flush ends need half "
           "bricks")
      .mustBeGiven()
      .atLeast(1)
      .atMost(1e5);
  keys.add("gap", wall.gap, "distance between neighbouring bricks in all directions")
      .in("m")
      .atLeast(0);
  keys.add("ends", wall.ends,
           "flush: odd courses begin and end with a half brick; ragged: they are shifted by half a "
           "brick");
}

void meshKeys(BlockKeys& keys, MeshConfig& mesh) {
  keys.add("file", mesh.file,
           "Exodus file of eight-node hexahedra; the path starts at the folder of the deck. Parts "
           "that "
           "share no nodes are separate bodies")
      .mustBeGiven();
}

void materialKeys(BlockKeys& keys, mechanics::Material& material) {
  keys.add(
      "model", material.model,
      "neo_hookean: finite strain, with ln J; svk: St. Venant-Kirchhoff, finite rotation but small "
      "strain; linear: small strain and rotation only");
  keys.add("density", material.density, "mass per volume of the undeformed body")
      .in("kg/m3")
      .mustBeGiven()
      .above(0);
  keys.add("youngs_modulus", material.youngs, "Young's modulus").in("Pa").mustBeGiven().above(0);
  keys.add("poissons_ratio", material.poisson, "Poisson's ratio")
      .mustBeGiven()
      .above(-1)
      .below(0.5);
}

void elementKeys(BlockKeys& keys, Config& config) {
  keys.add("formulation", config.formulation,
           "one_point: one integration point with physical stabilisation; full: 2x2x2 integration "
           "points, slower");
  keys.add("mass", config.mass,
           "inertia: nodal masses that give each body its exact mass, centre and inertia tensor; "
           "row_sum: an eighth of each element at each of its corners");
}

WallConfig readWall(Deck& deck) {
  WallConfig wall;
  readBlock(deck, "wall", wallKeys, wall);
  if (!deck.isGood("wall", "bricks") || !deck.isGood("wall", "elements"))
    return wall;
  const bool has_half_bricks = wall.ends == Ends::flush && wall.bricks[2] > 1;
  if (has_half_bricks && wall.elements[0] % 2 != 0)
    deck.complain("wall", "elements", "an odd number of elements along a brick",
                  "an even number, which flush ends need for half bricks (or ends = \"ragged\")");
  if (deck.isGood("wall", "brick") && has_half_bricks && wall.gap >= wall.brick[0])
    deck.complain("wall", "gap", "a gap as long as a brick", "a shorter gap, for half bricks");
  constexpr double max_elements = 1e15;
  double elements = 1;
  for (int d = 0; d < 3; ++d)
    elements *= static_cast<double>(wall.bricks[d]) * static_cast<double>(wall.elements[d]);
  if (elements > max_elements)
    deck.complain("wall", "bricks", "a wall of more than 1e15 elements", "a smaller wall");
  return wall;
}

MeshConfig readMesh(Deck& deck) {
  namespace fs = std::filesystem;
  MeshConfig mesh;
  readBlock(deck, "mesh", meshKeys, mesh);
  if (!deck.isGood("mesh", "file"))
    return mesh;
  if (mesh.file.empty()) {
    deck.complain("mesh", "file", "an empty path", "the path of an Exodus file");
    return mesh;
  }
  const fs::path given = mesh.file, folder = fs::path(deck.path()).parent_path();
  mesh.file =
      fs::absolute(given.is_absolute() ? given : folder / given).lexically_normal().string();
  deck.assignText("mesh", "file", mesh.file);
  return mesh;
}

void readMaterials(Deck& deck, std::vector<MaterialConfig>& materials) {
  for (const std::string& name : deck.names("material")) {
    const std::string block = "material." + name;
    materials.push_back({name, {}, deck.placeOf(block)});
    readBlock(deck, block, materialKeys, materials.back().material);
  }
  if (materials.empty())
    deck.complain("", "", "no material", "a table such as [material.brick]");
  if (!deck.hasBlock("wall"))
    return;
  for (const MaterialConfig& material : materials)
    if (material.block != "brick" && material.block != "half_brick")
      deck.complain("material." + material.block, "", "the name \"" + material.block + "\"",
                    "one of the wall's blocks, \"brick\" or \"half_brick\"");
  const bool has_brick = std::any_of(materials.begin(), materials.end(),
                                     [](const auto& m) { return m.block == "brick"; });
  if (!materials.empty() && !has_brick)
    deck.complain("", "", "no [material.brick]", "the material of the wall's bricks");
}

} // namespace

io::Schema sceneBlocks() {
  return {
      withKeys({"", BlockKind::top, ""}, topKeys),
      withKeys({"wall", BlockKind::single,
                "a wall of bricks in running bond; each brick has a mesh of its own, and only "
                "contact joins "
                "bricks"},
               wallKeys),
      withKeys({"mesh", BlockKind::single,
                "a mesh from an Exodus file, in place of [wall]; blocks, side sets and node sets "
                "are used by "
                "their names"},
               meshKeys),
      withKeys(
          {"material", BlockKind::named,
           "material of the element block <name>; walls, and meshes written from them, have the "
           "blocks brick and half_brick, and without [material.half_brick] both have that of "
           "brick"},
          materialKeys),
      withKeys({"element", BlockKind::single, "the hexahedral element"}, elementKeys),
  };
}

void readScene(Deck& deck, Config& config) {
  readBlock(deck, "", topKeys, config);
  const bool has_wall = deck.hasBlock("wall"), has_mesh = deck.hasBlock("mesh");
  if (has_wall)
    config.wall = readWall(deck);
  if (has_mesh)
    config.mesh = readMesh(deck);
  if (has_wall && has_mesh)
    deck.complain("mesh", "", "[mesh] beside [wall]", "exactly one of them");
  if (!has_wall && !has_mesh)
    deck.complain("", "", "neither [wall] nor [mesh]", "exactly one of them");
  readMaterials(deck, config.materials);
  readBlock(deck, "element", elementKeys, config);
}

} // namespace brickwall::miniapp
