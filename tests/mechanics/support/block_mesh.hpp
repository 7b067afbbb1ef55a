// Small meshes of structured blocks for tests, each block a body, divided among the ranks by any
// rule. Every rank generates the whole mesh and keeps its part, so tests can compare with the
// whole.
#pragma once

#include "contact/base/hash.hpp"
#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "contact/base/vec3.hpp"
#include "mechanics/force/internal_force.hpp"
#include "mechanics/mesh/hex_mesh.hpp"
#include "mechanics/mesh/host_mesh.hpp"
#include "mechanics/mesh/lumped_mass.hpp"
#include "mechanics/mesh/nodal_state.hpp"
#include "mechanics/mesh/shared_node_sum.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <set>
#include <vector>

namespace brickwall::mechanics::testing {

struct Block {
  int elements[3] = {1, 1, 1};
  Vec3 size = {1, 1, 1};
  Vec3 origin = {};
  int material = 0;
};

// Blocks of these numbers of elements (0.1 x 0.2 x 0.15 each), one above the other, 4 apart.
inline std::vector<Block> stackOf(const std::vector<std::array<int, 3>>& sizes) {
  std::vector<Block> blocks;
  for (const auto& size : sizes) {
    Block block;
    std::copy(size.begin(), size.end(), block.elements);
    block.size = {0.1 * size[0], 0.2 * size[1], 0.15 * size[2]};
    block.origin.z = 4.0 * blocks.size();
    blocks.push_back(block);
  }
  return blocks;
}

struct BlockMesh {
  HexMesh mesh;
  SharedNodeLists shared;
  SharedNodeSum sum;
  global_id num_global_nodes = 0, num_global_elems = 0;
  std::vector<global_id> node_ids; // host copy of mesh.node_ids
};

const MPI_Comm world = MPI_COMM_WORLD;
constexpr MaterialModel all_models[] = {MaterialModel::neo_hookean, MaterialModel::svk,
                                        MaterialModel::linear};

using Placement = std::function<Vec3(const Vec3&)>; // moves the nodes of the regular grid
using Partition = std::function<int(global_id)>; // rank of an element

inline Material steelLike(MaterialModel model = MaterialModel::neo_hookean, double poisson = 0.3) {
  return {model, 1.0, 1.0, poisson};
}
inline Vec3 asIs(const Vec3& x) {
  return x;
}
inline int onOneRank(global_id) {
  return 0;
}
inline int slices(global_id elem) {
  return static_cast<int>(elem / 3 % sizeOf(world));
}
inline int scattered(global_id elem) {
  return static_cast<int>((elem * 2654435761u >> 7) % sizeOf(world));
}
inline Vec3 randomVector(std::uint64_t seed) { // components in [-1, 1]
  return {randomOf(seed), randomOf(seed + 1), randomOf(seed + 2)};
}
inline Block cube(int n, const Vec3& origin = {}) {
  return {{n, n, n}, {1, 1, 1}, origin};
}

inline BlockMesh makeBlocks(const exec_space& space, MPI_Comm comm,
                            const std::vector<Block>& blocks,
                            const std::vector<Material>& materials, const Placement& place = asIs,
                            Partition partition = nullptr) {
  const int size = sizeOf(comm), rank = rankOf(comm);
  if (!partition)
    partition = [size](global_id elem) { return static_cast<int>(elem % size); };
  struct Elem {
    global_id id;
    int body;
    global_id nodes[8];
  };
  std::vector<Elem> elems;
  std::vector<Vec3> nodes;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const int* n = blocks[b].elements;
    const auto first = static_cast<global_id>(nodes.size());
    const auto at = [&](int i, int j, int k) {
      return first + i + (n[0] + 1) * (j + static_cast<global_id>(n[1] + 1) * k);
    };
    for (int k = 0; k <= n[2]; ++k)
      for (int j = 0; j <= n[1]; ++j)
        for (int i = 0; i <= n[0]; ++i)
          nodes.push_back(place(blocks[b].origin + Vec3{blocks[b].size.x * i / n[0],
                                                        blocks[b].size.y * j / n[1],
                                                        blocks[b].size.z * k / n[2]}));
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i)
          elems.push_back(
              {static_cast<global_id>(elems.size()),
               static_cast<int>(b),
               {at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k), at(i, j, k + 1),
                at(i + 1, j, k + 1), at(i + 1, j + 1, k + 1), at(i, j + 1, k + 1)}});
  }
  std::vector<std::set<int>> sharers(nodes.size());
  for (const Elem& e : elems)
    for (const global_id node : e.nodes)
      sharers[node].insert(partition(e.id));

  BlockMesh out;
  out.num_global_nodes = static_cast<global_id>(nodes.size());
  out.num_global_elems = static_cast<global_id>(elems.size());
  std::map<global_id, int> local;
  std::vector<unsigned char> owned;
  std::vector<double> coordinates;
  std::map<int, std::vector<int>> shared;
  for (global_id node = 0; node < out.num_global_nodes; ++node)
    if (sharers[node].count(rank)) {
      const int index = static_cast<int>(out.node_ids.size());
      local[node] = index;
      out.node_ids.push_back(node);
      owned.push_back(*sharers[node].begin() == rank);
      for (int j = 0; j < 3; ++j)
        coordinates.push_back(nodes[node][j]);
      for (const int other : sharers[node])
        if (other != rank)
          shared[other].push_back(index);
    }
  std::vector<global_id> elem_ids;
  std::vector<int> elem_nodes, elem_block;
  HexMesh& mesh = out.mesh;
  for (const Elem& e : elems)
    if (partition(e.id) == rank) {
      if (mesh.bodies.empty() || mesh.bodies.back().body != e.body)
        mesh.bodies.push_back({static_cast<int>(elem_ids.size()), 0, e.body});
      ++mesh.bodies.back().count;
      elem_ids.push_back(e.id);
      elem_block.push_back(blocks[e.body].material);
      for (const global_id node : e.nodes)
        elem_nodes.push_back(local.at(node));
    }
  mesh.num_nodes = static_cast<int>(out.node_ids.size());
  mesh.num_elems = static_cast<int>(elem_ids.size());
  mesh.elem_to_nodes = toDevice<View<int* [8]>>(space, "test::elem_to_nodes", elem_nodes);
  mesh.elem_ids = toDevice(space, "test::elem_ids", elem_ids);
  mesh.node_ids = toDevice(space, "test::node_ids", out.node_ids);
  mesh.node_is_owned = toDevice(space, "test::node_is_owned", owned);
  mesh.elem_block = toDevice(space, "test::elem_block", elem_block);
  mesh.materials = toDevice(space, "test::materials", materials);
  mesh.reference_coordinates = toDevice<View<double* [3]>>(space, "test::X", coordinates);
  for (const auto& [other, list] : shared) {
    out.shared.ranks.push_back(other);
    out.shared.nodes.push_back(list);
  }
  out.sum = SharedNodeSum(space, comm, out.shared);
  return out;
}

// A vector field of the reference position on the mesh's nodes.
inline View<double* [3]> nodalField(const exec_space& space, const HexMesh& mesh,
                                    const std::function<Vec3(const Vec3&)>& field) {
  const auto X = toHost(mesh.reference_coordinates);
  std::vector<double> values;
  for (int node = 0; node < mesh.num_nodes; ++node) {
    const Vec3 value = field(rowOf(X, node));
    for (int j = 0; j < 3; ++j)
      values.push_back(value[j]);
  }
  return toDevice<View<double* [3]>>(space, "test::field", values);
}

inline NodalState stateAtRest(const exec_space& space, MPI_Comm comm, BlockMesh& blocks) {
  NodalState state;
  state.displacement = View<double* [3]>("test::displacement", blocks.mesh.num_nodes);
  state.velocity = View<double* [3]>("test::velocity", blocks.mesh.num_nodes);
  state.mass = lumpedMass(space, comm, blocks.mesh, blocks.sum);
  return state;
}

inline NodalForces zeroedForces(const HexMesh& mesh, Quantum quantum, bool has_viscosity = false) {
  return {ForceColumns("test::forces", mesh.num_nodes, numForceColumns(has_viscosity)), quantum};
}

// Words of nodal values [node] or [node][W] by global id, the same on every rank: [global node][W].
template <class ViewType>
std::vector<std::int64_t> globalWords(MPI_Comm comm, const BlockMesh& blocks,
                                      const ViewType& values) {
  const auto host = toHost(values);
  const auto owned = toHost(blocks.mesh.node_is_owned);
  const int columns =
      allReduce(comm, ViewType::rank == 1 ? 1 : static_cast<int>(host.extent(1)), MPI_MAX);
  std::vector<std::int64_t> result(blocks.num_global_nodes * columns, 0);
  for (int node = 0; node < blocks.mesh.num_nodes; ++node)
    for (int w = 0; owned(node) && w < columns; ++w) {
      std::int64_t word;
      if constexpr (ViewType::rank == 1)
        memcpy(&word, &host(node), sizeof word);
      else
        memcpy(&word, &host(node, w), sizeof word);
      result[blocks.node_ids[node] * columns + w] = word;
    }
  allReduce(comm, result.data(), static_cast<int>(result.size()), MPI_SUM);
  return result;
}

// Internal force and energy of one mesh at a displacement.
struct Evaluation {
  std::vector<std::int64_t> forces; // [global node][9], quanta, totals
  double material = 0, hourglass = 0; // energies of all ranks
  double quantum = 1;
  InternalForceResult local;
  double force(global_id node, int i) const {
    return quantum * static_cast<double>(forces[9 * node + i]);
  }
};
inline LimbScale testEnergyScale() {
  return LimbScale::forLargest(1e6);
}

inline Evaluation evaluate(const exec_space& space, MPI_Comm comm, BlockMesh& blocks,
                           const View<double* [3]>& displacement, ElementKind kind) {
  Evaluation result;
  const Quantum quantum = Quantum::forForceScale(forceScale(space, comm, blocks.mesh));
  InternalForce internal(space, comm, blocks.mesh, kind, quantum, testEnergyScale());
  const NodalForces forces = zeroedForces(blocks.mesh, quantum);
  result.local = internal.add(space, displacement, forces, true);
  blocks.sum.sum(space, forces.values);
  space.fence();
  result.forces = globalWords(comm, blocks, forces.values);
  auto energy = result.local.energy;
  allReduce(comm, energy);
  result.material = energy.sum[stored_material].value(testEnergyScale());
  result.hourglass = energy.sum[stored_hourglass].value(testEnergyScale());
  result.quantum = quantum.value;
  return result;
}

} // namespace brickwall::mechanics::testing
