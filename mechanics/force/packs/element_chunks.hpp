// Division of work in the element kernels: packs of simd_width elements form chunks, each handled
// by one thread. On a host a chunk is a whole body where that balances, so that no two threads
// touch one node. Larger bodies are cut, and only packs whose nodes belong to another chunk add
// atomically. On a device every element is a chunk.
#pragma once

#include "mechanics/mesh/brick_lattice.hpp"
#include "mechanics/mesh/hex_mesh.hpp"

namespace brickwall::mechanics {

// Elements [first, first + count) of one chunk, count <= simd_width.
struct ElementPack {
  int first = 0, count = 0;
  int atomic = 0; // another chunk touches its nodes
};

// Packs [first_pack, first_pack + num_packs) of one body and one block.
struct ElementChunk {
  int first_pack = 0, num_packs = 0;
  int body = 0; // row of HexMesh::bodies
  int block = 0;
  // row of the body's lattice, whose sweep may handle the elements instead; -1 without a lattice
  int lattice = -1;
  int shape = -1; // row of the body in the table of shapes if it is congruent, otherwise -1
  int geometry_row = -1; // row of its first pack's geometry if neither congruent nor in a lattice
};

// Chunks of one material model, [first, first + count).
struct ChunkGroup {
  MaterialModel model = MaterialModel::neo_hookean;
  int first = 0, count = 0;
};

struct ElementChunks {
  View<ElementChunk*> chunks;
  View<ElementPack*> packs;
  std::vector<ChunkGroup> groups;
  bool all_in_lattices = true;
  int num_geometry_rows = 0; // packs of bodies that are not congruent, those of lattices first
};

// `threads` is the number of threads that work at once. Host code for set-up; not collective.
ElementChunks cutIntoChunks(const exec_space& space, const HexMesh& mesh,
                            const std::vector<BodyShape>& shapes,
                            const std::vector<BrickLattice>& lattices, int threads);

} // namespace brickwall::mechanics
