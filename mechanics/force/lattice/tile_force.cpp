// Kernel of tile_force.hpp. A team holds the displacements of three planes of nodes in its scratch
// memory: the two of a layer of elements, and the next one, which arrives meanwhile. Each element
// adds its forces to entries of its own, one for each of its corners, and the four entries of a
// node are summed when the plane is complete. The elements above a plane come one layer later than
// those below it. Integer sums do not depend on the order.
#include "mechanics/force/lattice/tile_force.hpp"

#include "contact/base/lane_sums.hpp"
#include "mechanics/force/packs/round_forces.hpp"

namespace brickwall::mechanics {

namespace {

constexpr int face_corners = 4;

// What the elements of a tile have in common.
template <class Shape>
struct TileElement {
  Shape shape;
  typename StiffnessOf<Shape>::type stiffness;
};

// The scratch memory of a team. Planes have entries for most nodes, so that all offsets are
// constant.
template <class Shape>
struct TileScratch {
  static constexpr int nodes = LatticeTile::max_plane_nodes, planes = 3;

  TileElement<Shape> element;
  double displacement[planes][3][nodes]; // [plane % planes][xyz][node]
  // forces of the elements at each of their corners on a plane [plane % 2][corner][xyz][node]
  std::int64_t force[2][face_corners][3][nodes];
  int lattice_node[nodes]; // number in the lattice's plane, or minus that less 1 on a seam
  int first_corner[LatticeTile::max_columns]; // node of the first corner of a column's elements
};

struct TileForceArguments {
  View<const LatticeTile*> tiles;
  View<const BrickLattice*> lattices;
  View<const CongruentShape*> shapes; // [body]
  View<const Material*> materials; // [block]
  View<const global_id*> elem_ids;
  View<const int*> is_resting;
  View<const double* [3]> displacement;
  ForceColumns forces;
  double inverse_quantum;
  SplitScale energy_scale;
  bool with_energy;
};

template <MaterialModel model, class Shape>
struct TileForces {
  using policy = Kokkos::TeamPolicy<exec_space, Kokkos::LaunchBounds<LatticeTile::max_columns, 3>,
                                    launch_by_argument>;
  using member_type = typename policy::member_type;

  TileForceArguments a;
  int first_tile;

  // The tile of a team and its place in the mesh.
  struct Place {
    const LatticeTile& tile;
    const BrickLattice& lattice;
    int row, nodes; // of a plane of the tile
    KOKKOS_INLINE_FUNCTION bool isSeam(int axis, int layers, int at) const {
      return (at == 0 && tile.first[axis] > 0) ||
             (at == tile.count[axis] && tile.first[axis] + tile.count[axis] < layers);
    }
    KOKKOS_INLINE_FUNCTION int firstNode(int plane) const {
      return lattice.first_node + (tile.first[2] + plane) * lattice.planeNodes();
    }
  };

  KOKKOS_INLINE_FUNCTION void operator()(const member_type& team, ForceSums& sums) const {
    const LatticeTile tile = a.tiles(first_tile + team.league_rank());
    const BrickLattice lattice = a.lattices(tile.lattice);
    // The forces of a body at rest remain those of the start, which are zero.
    if (a.is_resting.extent(0) > 0 && a.is_resting(lattice.body) != 0)
      return;
    const int row = tile.count[0] + 1;
    const Place place{tile, lattice, row, row * (tile.count[1] + 1)};
    auto& scratch =
        *static_cast<TileScratch<Shape>*>(team.team_shmem().get_shmem(sizeof(TileScratch<Shape>)));
    prepare(team, place, scratch);
    team.team_barrier();
    startLoad(team, place, 0, scratch);
    startLoad(team, place, 1, scratch);
    finishCopies();
    team.team_barrier();
    SplitSums<num_stored_energies> energy;
    for (int layer = 0; layer < tile.count[2]; ++layer) {
      if (layer + 2 <= tile.count[2])
        startLoad(team, place, layer + 2, scratch);
      for (int c = team.team_rank(); c < tile.count[0] * tile.count[1]; c += team.team_size())
        addElement(place, layer, scratch.first_corner[c], scratch, energy, sums);
      team.team_barrier();
      store(team, place, layer, scratch);
      finishCopies();
      team.team_barrier();
      if constexpr (host_accessible) // where a thread has many columns
        fold(energy, sums);
    }
    store(team, place, tile.count[2], scratch);
    fold(energy, sums);
  }

  KOKKOS_INLINE_FUNCTION void prepare(const member_type& team, const Place& place,
                                      TileScratch<Shape>& scratch) const {
    const LatticeTile& tile = place.tile;
    for (int n = team.team_rank(); n < place.nodes; n += team.team_size()) {
      const int i = n % place.row, j = n / place.row;
      const int number = tile.first[0] + i + place.lattice.rowNodes() * (tile.first[1] + j);
      scratch.lattice_node[n] =
          place.isSeam(0, place.lattice.nx, i) || place.isSeam(1, place.lattice.ny, j) ? -1 - number
                                                                                       : number;
      for (int k = 0; k < 6 * face_corners; ++k)
        (&scratch.force[0][0][0][n])[k * scratch.nodes] = 0;
    }
    for (int c = team.team_rank(); c < tile.count[0] * tile.count[1]; c += team.team_size())
      scratch.first_corner[c] = c % tile.count[0] + place.row * (c / tile.count[0]);
    if (team.team_rank() == 0) {
      TileElement<Shape>& element = scratch.element;
      if constexpr (std::is_same<Shape, OnePointBrick>::value)
        element.shape = a.shapes(place.lattice.body).brick;
      else
        element.shape = a.shapes(place.lattice.body).box;
      element.stiffness = stiffnessOf(
          element.shape, ElementModuli::of(a.materials(place.lattice.block)), a.inverse_quantum);
    }
  }

  KOKKOS_INLINE_FUNCTION void startLoad(const member_type& team, const Place& place, int plane,
                                        TileScratch<Shape>& scratch) const {
    auto& to = scratch.displacement[plane % scratch.planes];
    for (int n = team.team_rank(); n < place.nodes; n += team.team_size()) {
      const int number = scratch.lattice_node[n];
      const std::int64_t node = place.firstNode(plane) + (number < 0 ? -1 - number : number);
      for (int i = 0; i < 3; ++i)
        startCopy(to[i][n], a.displacement(node, i));
    }
  }

  KOKKOS_INLINE_FUNCTION void store(const member_type& team, const Place& place, int plane,
                                    TileScratch<Shape>& scratch) const {
    const bool is_seam = place.isSeam(2, place.lattice.nz, plane);
    for (int n = team.team_rank(); n < place.nodes; n += team.team_size()) {
      const int number = scratch.lattice_node[n];
      const std::int64_t node = place.firstNode(plane) + (number < 0 ? -1 - number : number);
      for (int i = 0; i < 3; ++i) {
        std::int64_t sum = 0;
        for (int c = 0; c < face_corners; ++c)
          sum += scratch.force[plane % 2][c][i][n];
        std::int64_t& force = a.forces(node, 3 * internal_force + i);
        if (is_seam || number < 0)
          Kokkos::atomic_add(&force, sum);
        else
          force = sum;
      }
    }
  }

  struct TakeForces {
    std::int64_t (&modes)[3][num_modes];
    double& largest;
    KOKKOS_FORCEINLINE_FUNCTION void operator()(int axis, const double (&force)[num_modes]) const {
      roundModes(force, largest, modes[axis]);
    }
  };

  // The element between planes `layer` and layer + 1 whose first corner is at node n of a plane.
  KOKKOS_FORCEINLINE_FUNCTION void addElement(const Place& place, int layer, int n,
                                              TileScratch<Shape>& scratch,
                                              SplitSums<num_stored_energies>& energy,
                                              ForceSums& sums) const {
    const int low = layer % 2, high = 1 - low;
    const auto& u_low = scratch.displacement[layer % scratch.planes];
    const auto& u_high = scratch.displacement[(layer + 1) % scratch.planes];
    const int corner_node[face_corners] = {n, n + 1, n + place.row + 1, n + place.row};
    double u[3][num_modes];
    for (int i = 0; i < 3; ++i) {
      double corner[8];
      for (int c = 0; c < face_corners; ++c) {
        corner[c] = u_low[i][corner_node[c]];
        corner[face_corners + c] = u_high[i][corner_node[c]];
      }
      cornersToModes(corner, u[i]);
    }
    std::int64_t modes[3][num_modes];
    double largest = 0;
    OnePointPoint<double> point;
    onePointForcesByAxis<model, VolumeChange::any>(u, scratch.element.shape,
                                                   scratch.element.stiffness, a.with_energy,
                                                   TakeForces{modes, largest}, point);
    const int reason = failureReason(point.J, largest);
    if (reason != no_failure) {
      sums.failure.add(a.elem_ids(elemOf(place, layer, n)), reason);
      for (int i = 0; i < 3; ++i)
        for (int m = 0; m < num_modes; ++m)
          modes[i][m] = 0;
    } else if (a.with_energy) {
      energy.add(stored_material, point.material_energy, a.energy_scale);
      energy.add(stored_hourglass, point.hourglass_energy, a.energy_scale);
      energy.endRow();
    }
    for (int i = 0; i < 3; ++i) {
      std::int64_t corner[8];
      modesToCorners(modes[i], corner);
      for (int c = 0; c < face_corners; ++c) {
        scratch.force[low][c][i][corner_node[c]] += corner[c];
        scratch.force[high][c][i][corner_node[c]] = corner[face_corners + c];
      }
    }
  }
  KOKKOS_INLINE_FUNCTION static int elemOf(const Place& place, int layer, int n) {
    const BrickLattice& lattice = place.lattice;
    const LatticeTile& tile = place.tile;
    const int i = tile.first[0] + n % place.row, j = tile.first[1] + n / place.row;
    return lattice.first_elem + i + lattice.nx * (j + lattice.ny * (tile.first[2] + layer));
  }

  KOKKOS_INLINE_FUNCTION void fold(SplitSums<num_stored_energies>& energy, ForceSums& sums) const {
    energy.foldInto(
        sums.energy, [](int i) { return i; },
        [&](int) -> const SplitScale& { return a.energy_scale; });
  }
};

template <MaterialModel model, class Shape>
void launch(const exec_space& space, const TileGroup& group, const TileForceArguments& a,
            LaunchedSums<ForceSums>& sums) {
  using Functor = TileForces<model, Shape>;
  auto policy =
      typename Functor::policy(space, group.count, host_accessible ? 1 : LatticeTile::max_columns);
  policy.set_scratch_size(0, Kokkos::PerTeam(sizeof(TileScratch<Shape>)));
  Kokkos::parallel_reduce("mechanics::InternalForce::add::tiles", policy, Functor{a, group.first},
                          sums.next(space));
}

template <MaterialModel model>
void launch(const exec_space& space, const TileGroup& group, const TileForceArguments& a,
            LaunchedSums<ForceSums>& sums) {
  if (group.is_brick)
    launch<model, OnePointBrick>(space, group, a, sums);
  else
    launch<model, OnePointBox>(space, group, a, sums);
}

} // namespace

void addTileForces(const exec_space& space, const LatticeTiles& tiles,
                   const ForceArguments& arguments, LaunchedSums<ForceSums>& sums) {
  const TileForceArguments a{tiles.tiles,
                             tiles.lattices,
                             arguments.tables.boxes,
                             arguments.tables.mesh.materials,
                             arguments.tables.mesh.elem_ids,
                             arguments.is_resting,
                             arguments.displacement,
                             arguments.forces,
                             arguments.inverse_quantum,
                             SplitScale::of(arguments.energy_scale),
                             arguments.with_energy};
  for (const TileGroup& group : tiles.groups)
    switch (group.model) {
    case MaterialModel::neo_hookean:
      launch<MaterialModel::neo_hookean>(space, group, a, sums);
      break;
    case MaterialModel::svk:
      launch<MaterialModel::svk>(space, group, a, sums);
      break;
    default:
      launch<MaterialModel::linear>(space, group, a, sums);
    }
}

} // namespace brickwall::mechanics
