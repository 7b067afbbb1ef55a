// How the element kernels divide the work: packs of simd_width elements, gathered into chunks that one thread handles.
// On a host a chunk is a whole body where that balances, so that no two threads touch one node; larger bodies are cut,
// and only packs whose nodes another chunk touches add atomically. On a device every element is a chunk.
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
  int lattice =
      -1; // the body's row in the table of lattices, where sweeps over these may handle the elements instead
  int shape = -1; // the body's row in the table of shapes when it is congruent, else -1
  int geometry_row = -1; // of its first pack, else; lattices know theirs
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

// `threads`: how many work at once. Host code for set-up; not collective.
ElementChunks cutIntoChunks(const exec_space& space, const HexMesh& mesh,
                            const std::vector<BodyShape>& shapes,
                            const std::vector<BrickLattice>& lattices, int threads);

} // namespace brickwall::mechanics
