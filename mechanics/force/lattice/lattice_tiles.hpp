// Division of lattices into tiles: a team of threads of a device takes the columns of elements of a
// tile, one a thread, and goes up its layers (tile_force.hpp).
#pragma once

#include "mechanics/mesh/brick_lattice.hpp"

namespace brickwall::mechanics {

// Elements [first, first + count) along i, j and k.
struct LatticeTile {
  static constexpr int max_columns = 128, max_plane_nodes = 168, max_layers = 1024;

  int lattice = 0; // row of a list
  int first[3] = {0, 0, 0}, count[3] = {0, 0, 0};
};

// Tiles [first, first + count) of one material model and one kind of shape.
struct TileGroup {
  MaterialModel model = MaterialModel::neo_hookean;
  bool is_brick = false; // OnePointBrick, otherwise OnePointBox
  int first = 0, count = 0;
};

struct LatticeTiles {
  std::vector<BrickLattice> on_host; // lattices with tiles
  View<BrickLattice*> lattices;
  View<LatticeTile*> tiles;
  std::vector<TileGroup> groups;
  View<int*> seam_nodes; // on faces between tiles, and those outside of all tiles
  bool any() const { return !groups.empty(); }
};

// Cuts those of the lattices whose elements are congruent, and that have enough columns to fill a
// team. `threads` is the number of threads that work at once. Host code for set-up; not collective.
LatticeTiles cutIntoTiles(const exec_space& space, const HexMesh& mesh,
                          const std::vector<BodyShape>& shapes, int threads);

} // namespace brickwall::mechanics
