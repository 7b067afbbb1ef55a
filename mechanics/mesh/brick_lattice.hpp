// Bodies, or this rank's parts of them, that are lattices of hexahedra: nx x ny x nz elements and
// their nodes, both numbered consecutively with i fastest, then j, then k. Sweeps over them
// (lattice_sweep.hpp) need no connectivity.
#pragma once

#include "mechanics/mesh/congruent_bodies.hpp"
#include "mechanics/mesh/hex_mesh.hpp"

namespace brickwall::mechanics {

// Row and lane of ElementTables::geometry where the geometry of an element is stored.
struct GeometryPlace {
  int row = 0, lane = 0;
};

struct BrickLattice {
  int body = 0; // row of HexMesh::bodies
  int block = 0;
  int first_elem = 0, first_node = 0;
  int nx = 0, ny = 0, nz = 0; // numbers of elements
  int geometry_row = -1; // row of the first pack's geometry; -1 if the elements are congruent
  bool is_whole = false; // the whole body is on this rank, so that no other rank touches its nodes
  KOKKOS_INLINE_FUNCTION int rowNodes() const { return nx + 1; }
  KOKKOS_INLINE_FUNCTION int planeNodes() const { return (nx + 1) * (ny + 1); }
  KOKKOS_INLINE_FUNCTION int numNodes() const { return (nx + 1) * (ny + 1) * (nz + 1); }
  KOKKOS_INLINE_FUNCTION int numElems() const { return nx * ny * nz; }
  // Elements of a layer are placed in lanes by their lowest corner; one place at the end of each
  // row is empty.
  KOKKOS_INLINE_FUNCTION int layerPacks() const { return dividedUp(rowNodes() * ny, simd_width); }
  KOKKOS_INLINE_FUNCTION GeometryPlace geometryPlace(int elem) const {
    const int inside = elem - first_elem, i = inside % nx, j = inside / nx % ny;
    const int place = i + rowNodes() * j;
    return {geometry_row + inside / (nx * ny) * layerPacks() + place / simd_width,
            place % simd_width};
  }
};

// Node planes [first, last) of a lattice and the layer of elements above each, for one thread.
struct LatticeSlab {
  int lattice = 0; // row of a list
  int first = 0, last = 0;
};

// Lattices of this rank.
struct LatticeTables {
  std::vector<BrickLattice> on_host;
  View<BrickLattice*> lattices;
  View<double**> scratch; // [thread][number], memory of a sweep
};

// The bodies of one block that are lattices, with rows for the geometry of those that are not
// congruent. Host code for set-up; not collective.
std::vector<BrickLattice> findBrickLattices(const exec_space& space, const HexMesh& mesh,
                                            const std::vector<BodyShape>& shapes);

// Fills the tables, with `scratch_width` numbers of scratch memory per thread.
LatticeTables latticeTables(const exec_space& space, const std::vector<BrickLattice>& lattices,
                            std::int64_t scratch_width);

// Slabs of the lattices `rows`. Lattices stay whole where that balances the threads.
std::vector<LatticeSlab> cutIntoSlabs(const std::vector<BrickLattice>& lattices,
                                      const std::vector<int>& rows, int threads);

} // namespace brickwall::mechanics
