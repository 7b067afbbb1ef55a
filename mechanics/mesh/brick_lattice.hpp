// Bodies (or this rank's parts of them) that are lattices of hexahedra: nx x ny x nz elements and their nodes, both numbered
// one after the other, i fastest, then j, then k. Sweeps over them (lattice_sweep.hpp) need no connectivity.
#pragma once

#include "mechanics/mesh/congruent_bodies.hpp"
#include "mechanics/mesh/hex_mesh.hpp"

namespace brickwall::mechanics {

// Where the numbers of an element's shape are stored: row and lane of ElementTables::geometry.
struct GeometryPlace {
  int row = 0, lane = 0;
};

struct BrickLattice {
  int body = 0; // row of HexMesh::bodies
  int block = 0;
  int first_elem = 0, first_node = 0;
  int nx = 0, ny = 0, nz = 0; // elements
  int geometry_row = -1; // of the first pack's geometry, where elements are not congruent
  bool is_whole = false; // all of the body is on this rank, so that no other rank touches its nodes
  KOKKOS_INLINE_FUNCTION int rowNodes() const { return nx + 1; }
  KOKKOS_INLINE_FUNCTION int planeNodes() const { return (nx + 1) * (ny + 1); }
  KOKKOS_INLINE_FUNCTION int numNodes() const { return (nx + 1) * (ny + 1) * (nz + 1); }
  KOKKOS_INLINE_FUNCTION int numElems() const { return nx * ny * nz; }
  // Elements of a layer stand in lanes by their lowest corner; a place at the end of each row is empty.
  KOKKOS_INLINE_FUNCTION int layerPacks() const {
    return (rowNodes() * ny + simd_width - 1) / simd_width;
  }
  KOKKOS_INLINE_FUNCTION GeometryPlace geometryPlace(int elem) const {
    const int inside = elem - first_elem, i = inside % nx, j = inside / nx % ny;
    const int place = i + rowNodes() * j;
    return {geometry_row + inside / (nx * ny) * layerPacks() + place / simd_width,
            place % simd_width};
  }
};

// Node planes [first, last) of a lattice, and the elements above each, for one thread.
struct LatticeSlab {
  int lattice = 0; // row of a list
  int first = 0, last = 0;
};

// Lattices of this rank.
struct LatticeTables {
  std::vector<BrickLattice> on_host;
  View<BrickLattice*> lattices;
  View<double**> scratch; // [thread][number] for a sweep
};

// The bodies of one block that are lattices, with rows for the geometry of those that are not congruent. Host code for set-up;
// not collective.
std::vector<BrickLattice> findBrickLattices(const exec_space& space, const HexMesh& mesh,
                                            const std::vector<BodyShape>& shapes);

// Fills the tables; `scratch_width` numbers for each thread.
LatticeTables latticeTables(const exec_space& space, const std::vector<BrickLattice>& lattices,
                            std::int64_t scratch_width);

// The slabs of some lattices (rows of `lattices`): whole ones where that balances between threads.
std::vector<LatticeSlab> cutIntoSlabs(const std::vector<BrickLattice>& lattices,
                                      const std::vector<int>& rows, int threads);

} // namespace brickwall::mechanics
