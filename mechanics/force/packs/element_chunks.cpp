#include "mechanics/force/packs/element_chunks.hpp"

#include "contact/base/error.hpp"
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
  return (share + simd_width - 1) / simd_width * simd_width;
}

struct Cut {
  int first, count, block, body;
};

std::vector<Cut> cutBodies(const HexMesh& mesh, const HostMesh& host, int largest) {
  std::vector<Cut> cuts;
  for (std::size_t b = 0; b < mesh.bodies.size(); ++b) {
    const int end = mesh.bodies[b].first + mesh.bodies[b].count;
    for (int first = mesh.bodies[b].first; first < end;) {
      const int block = host.elem_block(first);
      int next = first;
      while (next < end && next - first < largest && host.elem_block(next) == block)
        ++next;
      cuts.push_back({first, next - first, block, static_cast<int>(b)});
      first = next;
    }
  }
  return cuts;
}

// Whether a node belongs to two chunks or more.
std::vector<char> nodesOfSeveralChunks(const HexMesh& mesh, const HostMesh& host,
                                       const std::vector<Cut>& cuts) {
  std::vector<int> chunk_of_node(mesh.num_nodes, -1);
  std::vector<char> several(mesh.num_nodes, 0);
  for (std::size_t c = 0; c < cuts.size(); ++c)
    for (int elem = cuts[c].first; elem < cuts[c].first + cuts[c].count; ++elem)
      for (int corner = 0; corner < 8; ++corner) {
        const int node = host.elem_to_nodes(elem, corner);
        if (chunk_of_node[node] >= 0 && chunk_of_node[node] != static_cast<int>(c))
          several[node] = 1;
        chunk_of_node[node] = static_cast<int>(c);
      }
  return several;
}

} // namespace

ElementChunks cutIntoChunks(const exec_space& space, const HexMesh& mesh,
                            const std::vector<BodyShape>& shapes,
                            const std::vector<BrickLattice>& lattices, int threads) {
  const HostMesh host = copyToHost(space, mesh);
  std::vector<Cut> cuts = cutBodies(mesh, host, largestChunk(mesh.num_elems, threads));
  std::stable_sort(cuts.begin(), cuts.end(), [&](const Cut& a, const Cut& b) {
    return host.materials(a.block).model < host.materials(b.block).model;
  });
  // A device works on several chunks at once for any value of `threads`.
  const std::vector<char> several = threads > 1 || !host_accessible
                                        ? nodesOfSeveralChunks(mesh, host, cuts)
                                        : std::vector<char>(mesh.num_nodes, 0);

  ElementChunks result;
  std::vector<int> lattice_of_body(mesh.bodies.size(), -1);
  for (std::size_t row = 0; row < lattices.size(); ++row) {
    lattice_of_body[lattices[row].body] = static_cast<int>(row);
    if (lattices[row].geometry_row >= 0)
      result.num_geometry_rows += lattices[row].nz * lattices[row].layerPacks();
  }
  std::vector<ElementChunk> chunks;
  std::vector<ElementPack> packs;
  for (const Cut& cut : cuts) {
    const MaterialModel model = host.materials(cut.block).model;
    if (result.groups.empty() || result.groups.back().model != model)
      result.groups.push_back({model, static_cast<int>(chunks.size()), 0});
    ++result.groups.back().count;
    ElementChunk chunk;
    chunk.first_pack = static_cast<int>(packs.size());
    chunk.body = cut.body;
    chunk.block = cut.block;
    chunk.lattice = lattice_of_body[cut.body];
    result.all_in_lattices = result.all_in_lattices && chunk.lattice >= 0;
    for (int first = cut.first; first < cut.first + cut.count; first += simd_width) {
      ElementPack pack{first, std::min(simd_width, cut.first + cut.count - first), 0};
      for (int elem = first; elem < first + pack.count; ++elem)
        for (int corner = 0; corner < 8; ++corner)
          pack.atomic |= several[host.elem_to_nodes(elem, corner)];
      packs.push_back(pack);
    }
    chunk.num_packs = static_cast<int>(packs.size()) - chunk.first_pack;
    if (shapes[cut.body].congruent)
      chunk.shape = cut.body;
    else if (chunk.lattice < 0) {
      chunk.geometry_row = result.num_geometry_rows;
      result.num_geometry_rows += chunk.num_packs;
    }
    chunks.push_back(chunk);
  }
  result.chunks = toDevice(space, "mechanics::ElementChunks::chunks", chunks);
  result.packs = toDevice(space, "mechanics::ElementChunks::packs", packs);
  return result;
}

} // namespace brickwall::mechanics
