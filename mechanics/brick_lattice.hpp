// Bodies (or this rank's parts of them) that are lattices of hexahedra: nx x ny x nz elements and their nodes, both numbered
// one after the other, i fastest, then j, then k. Sweeps over them (brick_sweep.hpp) need no connectivity.
#pragma once

#include "mechanics/congruent_bodies.hpp"
#include "mechanics/hex_mesh.hpp"

namespace brickwall::mechanics {

struct BrickLattice {
  int body = 0; // row of HexMesh::bodies
  int block = 0;
  int first_elem = 0, first_node = 0;
  int nx = 0, ny = 0, nz = 0; // elements
  bool is_whole = false; // all of the body is on this rank, so that no other rank touches its nodes
  KOKKOS_INLINE_FUNCTION int rowNodes() const { return nx + 1; }
  KOKKOS_INLINE_FUNCTION int planeNodes() const { return (nx + 1) * (ny + 1); }
  KOKKOS_INLINE_FUNCTION int numNodes() const { return (nx + 1) * (ny + 1) * (nz + 1); }
  KOKKOS_INLINE_FUNCTION int numElems() const { return nx * ny * nz; }
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

// The congruent bodies that are lattices with elements along x, y, z in their own axes. Host code for set-up; not collective.
std::vector<BrickLattice> findBrickLattices(const exec_space& space, const HexMesh& mesh,
                                            const std::vector<BodyShape>& shapes);

// Fills the tables; `scratch_width` numbers for each thread.
LatticeTables latticeTables(const exec_space& space, const std::vector<BrickLattice>& lattices,
                            std::int64_t scratch_width);

// The slabs of some lattices (rows of `lattices`): whole ones where that balances between threads.
std::vector<LatticeSlab> cutIntoSlabs(const std::vector<BrickLattice>& lattices,
                                      const std::vector<int>& rows, int threads);

} // namespace brickwall::mechanics
