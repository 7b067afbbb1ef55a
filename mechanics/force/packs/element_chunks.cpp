#include "mechanics/force/packs/element_chunks.hpp"

#include "mechanics/mesh/host_mesh.hpp"

#include <algorithm>
#include <climits>

namespace brickwall::mechanics {

namespace {

// Largest number of elements of a chunk: a whole body on one thread, otherwise about eight chunks
// per thread.
int largestChunk(int num_elems, int threads) {
  if (simd_width == 1)
    return 1;
  if (threads == 1)
    return INT_MAX;
  const int share = std::max(num_elems / (8 * threads), 8 * simd_width);
  return dividedUp(share, simd_width) * simd_width;
}

// Consecutive elements of one body and one block, cut into chunks.
struct Run {
  int first = 0, count = 0, block = 0, body = 0;
  int first_chunk = 0, first_pack = 0, geometry_row = -1;
};

// The runs of each material model follow each other.
std::vector<Run> findRuns(const HexMesh& mesh, const HostMesh& host) {
  std::vector<Run> runs;
  for (std::size_t b = 0; b < mesh.bodies.size(); ++b) {
    const int end = mesh.bodies[b].first + mesh.bodies[b].count;
    for (int elem = mesh.bodies[b].first; elem < end; ++elem) {
      const int block = host.elem_block(elem);
      if (elem == mesh.bodies[b].first || block != runs.back().block)
        runs.push_back({elem, 0, block, static_cast<int>(b)});
      ++runs.back().count;
    }
  }
  std::stable_sort(runs.begin(), runs.end(), [&](const Run& a, const Run& b) {
    return host.materials(a.block).model < host.materials(b.block).model;
  });
  return runs;
}

struct Chunking {
  std::vector<Run> runs;
  int largest = 0; // number of elements of a chunk
  int num_chunks = 0, num_packs = 0;

  struct Part {
    const Run* run;
    int number; // of the chunk in its run
    int first, count; // its elements
  };
  Part part(std::int64_t chunk) const {
    const auto next =
        std::upper_bound(runs.begin(), runs.end(), chunk,
                         [](std::int64_t c, const Run& run) { return c < run.first_chunk; });
    const Run& run = *std::prev(next);
    const auto number = static_cast<int>(chunk - run.first_chunk);
    const int before = number * largest; // 0 if `largest` is INT_MAX
    return {&run, number, run.first + before, std::min(largest, run.count - before)};
  }
};

// Whether a node belongs to two chunks or more.
std::vector<char> nodesOfSeveralChunks(const HexMesh& mesh, const HostMesh& host,
                                       const Chunking& chunking) {
  std::vector<int> chunk_of_node(mesh.num_nodes, -1);
  std::vector<char> several(mesh.num_nodes, 0);
  parallelOnHost("mechanics::nodesOfSeveralChunks", chunking.num_chunks, [&](std::int64_t c) {
    const Chunking::Part part = chunking.part(c);
    const auto chunk = static_cast<int>(c);
    for (int elem = part.first; elem < part.first + part.count; ++elem)
      for (int corner = 0; corner < 8; ++corner) {
        const int node = host.elem_to_nodes(elem, corner);
        int owner = loadShared(chunk_of_node[node]);
        if (owner < 0)
          owner = Kokkos::atomic_compare_exchange(&chunk_of_node[node], -1, chunk);
        if (owner >= 0 && owner != chunk)
          storeShared(several[node], char(1));
      }
  });
  return several;
}

} // namespace

ElementChunks cutIntoChunks(const exec_space& space, const HexMesh& mesh,
                            const std::vector<BodyShape>& shapes,
                            const std::vector<BrickLattice>& lattices, int threads) {
  const HostMesh host = copyToHost(space, mesh);
  ElementChunks result;
  std::vector<int> lattice_of_body(mesh.bodies.size(), -1);
  for (std::size_t row = 0; row < lattices.size(); ++row) {
    lattice_of_body[lattices[row].body] = static_cast<int>(row);
    if (lattices[row].geometry_row >= 0)
      result.num_geometry_rows += lattices[row].nz * lattices[row].layerPacks();
  }
  Chunking chunking{findRuns(mesh, host), largestChunk(mesh.num_elems, threads)};
  for (Run& run : chunking.runs) {
    const MaterialModel model = host.materials(run.block).model;
    if (result.groups.empty() || result.groups.back().model != model)
      result.groups.push_back({model, chunking.num_chunks, 0});
    const int num_chunks = dividedUp(run.count, chunking.largest);
    const int num_packs = dividedUp(run.count, simd_width);
    run.first_chunk = chunking.num_chunks;
    run.first_pack = chunking.num_packs;
    chunking.num_chunks += num_chunks;
    chunking.num_packs += num_packs;
    result.groups.back().count += num_chunks;
    const bool has_lattice = lattice_of_body[run.body] >= 0;
    result.all_in_lattices = result.all_in_lattices && has_lattice;
    if (!shapes[run.body].congruent && !has_lattice) {
      run.geometry_row = result.num_geometry_rows;
      result.num_geometry_rows += num_packs;
    }
  }
  // A device works on several chunks at once for any value of `threads`.
  const std::vector<char> several = threads > 1 || !host_accessible
                                        ? nodesOfSeveralChunks(mesh, host, chunking)
                                        : std::vector<char>(mesh.num_nodes, 0);
  std::vector<ElementChunk> chunks = hostArray<ElementChunk>(chunking.num_chunks);
  std::vector<ElementPack> packs = hostArray<ElementPack>(chunking.num_packs);
  parallelOnHost("mechanics::cutIntoChunks", chunking.num_chunks, [&](std::int64_t c) {
    const Chunking::Part part = chunking.part(c);
    const Run& run = *part.run;
    const int packs_before = part.number * (chunking.largest / simd_width);
    ElementChunk& chunk = chunks[c];
    chunk.first_pack = run.first_pack + packs_before;
    chunk.num_packs = dividedUp(part.count, simd_width);
    chunk.body = run.body;
    chunk.block = run.block;
    chunk.lattice = lattice_of_body[run.body];
    chunk.shape = shapes[run.body].congruent ? run.body : -1;
    chunk.geometry_row = run.geometry_row < 0 ? -1 : run.geometry_row + packs_before;
    for (int p = 0; p < chunk.num_packs; ++p) {
      const int first = p * simd_width;
      ElementPack pack{part.first + first, std::min(simd_width, part.count - first), 0};
      for (int elem = pack.first; elem < pack.first + pack.count; ++elem)
        for (int corner = 0; corner < 8; ++corner)
          pack.atomic |= several[host.elem_to_nodes(elem, corner)];
      packs[chunk.first_pack + p] = pack;
    }
  });
  result.chunks = toDevice(space, "mechanics::ElementChunks::chunks", chunks);
  result.packs = toDevice(space, "mechanics::ElementChunks::packs", packs);
  return result;
}

} // namespace brickwall::mechanics
