#include "mechanics/force/lattice/lattice_tiles.hpp"

#include "contact/base/to_device.hpp"
#include "mechanics/element/hex8_one_point_geometry.hpp"

#include <algorithm>
#include <climits>
#include <map>

namespace brickwall::mechanics {

namespace {

// Numbers of tiles along i and j: as few as possible, of the fewest nodes.
struct Division {
  int along_i = 1, along_j = 1;
  static Division of(const BrickLattice& lattice) {
    Division best;
    int least_tiles = INT_MAX, least_nodes = INT_MAX;
    for (int a = 1; a <= lattice.nx; ++a) {
      const int ni = dividedUp(lattice.nx, a);
      const int most =
          std::min(LatticeTile::max_columns / ni, LatticeTile::max_plane_nodes / (ni + 1) - 1);
      if (most < 1)
        continue;
      const int b = dividedUp(lattice.ny, most), nodes = (ni + 1) * (dividedUp(lattice.ny, b) + 1);
      if (a * b < least_tiles || (a * b == least_tiles && nodes < least_nodes)) {
        best = {a, b};
        least_tiles = a * b;
        least_nodes = nodes;
      }
    }
    return best;
  }
};

// Number of tiles along k: more than one where there are too few columns for all threads, or too
// many layers.
int tilesAlongK(const BrickLattice& lattice, std::int64_t num_columns, int threads) {
  const auto wanted =
      static_cast<int>(minOf<std::int64_t>(threads / (4 * num_columns), lattice.nz / 4));
  return std::max(wanted, dividedUp(lattice.nz, LatticeTile::max_layers));
}

void appendTiles(int row, const BrickLattice& lattice, int pieces,
                 std::vector<LatticeTile>& tiles) {
  const Division division = Division::of(lattice);
  const int n[3] = {lattice.nx, lattice.ny, lattice.nz};
  const int parts[3] = {division.along_i, division.along_j, pieces};
  for (int c = 0; c < parts[2]; ++c)
    for (int b = 0; b < parts[1]; ++b)
      for (int a = 0; a < parts[0]; ++a) {
        LatticeTile tile;
        tile.lattice = row;
        const int at[3] = {a, b, c};
        for (int axis = 0; axis < 3; ++axis) {
          tile.first[axis] = n[axis] * at[axis] / parts[axis];
          tile.count[axis] = n[axis] * (at[axis] + 1) / parts[axis] - tile.first[axis];
        }
        tiles.push_back(tile);
      }
}

// Adds a tile's nodes to the counts of tiles at each node.
void countTile(const BrickLattice& lattice, const LatticeTile& tile, std::vector<char>& tiles_at) {
  for (int k = tile.first[2]; k <= tile.first[2] + tile.count[2]; ++k)
    for (int j = tile.first[1]; j <= tile.first[1] + tile.count[1]; ++j)
      for (int i = tile.first[0]; i <= tile.first[0] + tile.count[0]; ++i)
        ++tiles_at[lattice.first_node + i + lattice.rowNodes() * j + lattice.planeNodes() * k];
}

} // namespace

LatticeTiles cutIntoTiles(const exec_space& space, const HexMesh& mesh,
                          const std::vector<BodyShape>& shapes, int threads) {
  LatticeTiles result;
  std::int64_t num_columns = 0;
  for (const BrickLattice& lattice : findBrickLattices(space, mesh, shapes))
    if (shapes[lattice.body].congruent && 4 * lattice.nx * lattice.ny >= LatticeTile::max_columns) {
      result.on_host.push_back(lattice);
      num_columns += lattice.nx * lattice.ny;
    }
  if (result.on_host.empty())
    return result;

  const auto materials = toHost(mesh.materials);
  std::map<std::pair<MaterialModel, bool>, std::vector<LatticeTile>> by_kind;
  for (int row = 0; row < static_cast<int>(result.on_host.size()); ++row) {
    const BrickLattice& lattice = result.on_host[row];
    appendTiles(
        row, lattice, tilesAlongK(lattice, num_columns, threads),
        by_kind[{materials(lattice.block).model, isOnePointBrick(shapes[lattice.body].jacobian)}]);
  }
  std::vector<LatticeTile> tiles;
  std::vector<char> tiles_at(mesh.num_nodes, 0);
  for (const auto& [kind, group] : by_kind) {
    result.groups.push_back(
        {kind.first, kind.second, static_cast<int>(tiles.size()), static_cast<int>(group.size())});
    tiles.insert(tiles.end(), group.begin(), group.end());
  }
  for (const LatticeTile& tile : tiles)
    countTile(result.on_host[tile.lattice], tile, tiles_at);
  std::vector<int> seam_nodes;
  for (int node = 0; node < mesh.num_nodes; ++node)
    if (tiles_at[node] != 1)
      seam_nodes.push_back(node);
  result.lattices = toDevice(space, "mechanics::LatticeTiles::lattices", result.on_host);
  result.tiles = toDevice(space, "mechanics::LatticeTiles::tiles", tiles);
  result.seam_nodes = toDevice(space, "mechanics::LatticeTiles::seam_nodes", seam_nodes);
  return result;
}

} // namespace brickwall::mechanics
