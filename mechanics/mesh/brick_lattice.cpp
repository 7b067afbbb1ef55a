#include "mechanics/mesh/brick_lattice.hpp"

#include "mechanics/mesh/host_mesh.hpp"

#include <algorithm>
#include <map>

namespace brickwall::mechanics {

namespace {

// The only lattice that is consistent with the corners of the body's first element.
BrickLattice guessLattice(const HostMesh& host, const ElementRange& body) {
  const auto corner = [&](int c) { return host.elem_to_nodes(body.first, c); };
  BrickLattice lattice;
  lattice.block = host.elem_block(body.first);
  lattice.first_elem = body.first;
  lattice.first_node = corner(0);
  lattice.nx = corner(3) - corner(0) - 1;
  if (lattice.nx < 1 || (corner(4) - corner(0)) % (lattice.nx + 1) != 0)
    return BrickLattice();
  lattice.ny = (corner(4) - corner(0)) / (lattice.nx + 1) - 1;
  if (lattice.ny < 1 || body.count % (lattice.nx * lattice.ny) != 0)
    return BrickLattice();
  lattice.nz = body.count / (lattice.nx * lattice.ny);
  return lattice;
}

bool isLattice(const HostMesh& host, const BrickLattice& lattice) {
  const int row = lattice.rowNodes(), plane = lattice.planeNodes();
  const int offset[8] = {0, 1, row + 1, row, plane, plane + 1, plane + row + 1, plane + row};
  int elem = lattice.first_elem;
  for (int k = 0; k < lattice.nz; ++k)
    for (int j = 0; j < lattice.ny; ++j)
      for (int i = 0; i < lattice.nx; ++i, ++elem) {
        if (host.elem_block(elem) != lattice.block)
          return false;
        for (int c = 0; c < 8; ++c)
          if (host.elem_to_nodes(elem, c) !=
              lattice.first_node + i + row * j + plane * k + offset[c])
            return false;
      }
  return lattice.nz > 0;
}

} // namespace

std::vector<BrickLattice> findBrickLattices(const exec_space& space, const HexMesh& mesh,
                                            const std::vector<BodyShape>& shapes) {
  const HostMesh host = copyToHost(space, mesh);
  std::vector<BrickLattice> lattices;
  int geometry_rows = 0;
  std::map<global_id, int> rows; // ranges per body: several lattices of one body would share nodes
  for (const ElementRange& body : mesh.bodies)
    ++rows[body.body];
  for (std::size_t b = 0; b < mesh.bodies.size(); ++b) {
    BrickLattice lattice = guessLattice(host, mesh.bodies[b]);
    if (rows[mesh.bodies[b].body] > 1 || !isLattice(host, lattice))
      continue;
    lattice.body = static_cast<int>(b);
    lattice.is_whole = shapes[b].whole;
    if (!shapes[b].congruent) {
      lattice.geometry_row = geometry_rows;
      geometry_rows += lattice.nz * lattice.layerPacks();
    }
    lattices.push_back(lattice);
  }
  return lattices;
}

LatticeTables latticeTables(const exec_space& space, const std::vector<BrickLattice>& lattices,
                            std::int64_t scratch_width) {
  LatticeTables tables;
  tables.on_host = lattices;
  tables.lattices = toDevice(space, "mechanics::LatticeTables::lattices", lattices);
  if (!lattices.empty())
    tables.scratch =
        View<double**>("mechanics::LatticeTables::scratch",
                       Kokkos::Experimental::UniqueToken<exec_space>().size(), scratch_width);
  return tables;
}

// A slab also sweeps the layer of elements below it, so thin slabs cost more.
std::vector<LatticeSlab> cutIntoSlabs(const std::vector<BrickLattice>& lattices,
                                      const std::vector<int>& rows, int threads) {
  std::int64_t num_elems = 0;
  for (const int row : rows)
    num_elems += lattices[row].numElems();
  std::vector<LatticeSlab> slabs;
  for (const int row : rows) {
    const BrickLattice& lattice = lattices[row];
    const int planes = lattice.nz + 1;
    const auto largest = static_cast<int>(num_elems / (8 * threads) / (lattice.nx * lattice.ny));
    const int thickness = threads == 1 ? planes : std::max(std::min(planes, largest), 8);
    const int pieces = std::max(1, planes / thickness);
    for (int piece = 0; piece < pieces; ++piece)
      slabs.push_back({row, planes * piece / pieces, planes * (piece + 1) / pieces});
  }
  return slabs;
}

} // namespace brickwall::mechanics
