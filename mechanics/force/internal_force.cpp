#include "mechanics/force/internal_force.hpp"

#include "contact/base/error.hpp"
#include "contact/base/mpi.hpp"
#include "mechanics/force/lattice/lattice_force.hpp"
#include "mechanics/force/lattice/tile_force.hpp"
#include "mechanics/force/packs/element_fields_kernel.hpp"
#include "mechanics/mesh/host_mesh.hpp"

#include <algorithm>

namespace brickwall::mechanics {

double forceScale(const exec_space& space, MPI_Comm comm, const HexMesh& mesh) {
  const MeshViews m = viewsOf(mesh);
  double largest = 0;
  Kokkos::parallel_reduce(
      "mechanics::forceScale::elements", rangePolicy(space, mesh.num_elems),
      KOKKOS_LAMBDA(const std::int64_t elem, double& scale) {
        CornerCoordinates X;
        gatherCorners(m.elem_to_nodes, m.reference_coordinates, static_cast<int>(elem), X);
        const Material& material = m.materials(m.elem_block(elem));
        const double h = longestEdge(X);
        scale = maxOf(scale, (material.lambda() + 2 * material.mu()) * h * h);
      },
      Kokkos::Max<double>(largest));
  return allReduce(comm, largest, MPI_MAX);
}

void zeroForces(const exec_space& space, const NodalForces& forces) {
  bool any = false;
  for (int kind = 0; kind < num_force_kinds; ++kind)
    any = any || (forces.hasKind(kind) && forces.acts[kind]);
  if (!any)
    return;
  Kokkos::parallel_for(
      "mechanics::zeroForces", rangePolicy(space, forces.values.extent(0)),
      KOKKOS_LAMBDA(const std::int64_t node) {
        for (int kind = 0; kind < num_force_kinds; ++kind)
          if (forces.hasKind(kind) && forces.acts[kind])
            for (int d = 0; d < 3; ++d)
              forces.values(node, 3 * kind + d) = 0;
      });
}

namespace {

std::int64_t countCongruent(const HexMesh& mesh, const std::vector<BodyShape>& shapes) {
  std::int64_t count = 0;
  for (std::size_t b = 0; b < shapes.size(); ++b)
    count += shapes[b].congruent ? mesh.bodies[b].count : 0;
  return count;
}

} // namespace

InternalForce::InternalForce(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                             ElementKind kind, Quantum quantum, LimbScale energy_scale, int threads,
                             LatticeMethod lattice_method)
    : _threads(threads > 0 ? threads : concurrency(space)), _kind(kind), _quantum(quantum),
      _energy_scale(energy_scale) {
  const std::vector<BodyShape> shapes = markCongruentBodies(space, comm, mesh);
  if (kind == ElementKind::one_point && simd_width > 1 && lattice_method == LatticeMethod::planes) {
    const auto lattices = findBrickLattices(space, mesh, shapes);
    _lattices = latticeTables(space, lattices, latticeScratch(lattices));
  } else if (kind == ElementKind::one_point && lattice_method == LatticeMethod::tiles) {
    _tiles = cutIntoTiles(space, mesh, shapes, _threads);
  }
  skipLattices(space, {});
  const ElementChunks cut = cutIntoChunks(space, mesh, shapes, hostLattices(), _threads);
  _all_in_lattices = cut.all_in_lattices;
  _groups = cut.groups;
  _num_congruent_elems = countCongruent(mesh, shapes);
  _tables.mesh = viewsOf(mesh);
  _tables.num_elems = mesh.num_elems;
  _tables.chunks = cut.chunks;
  _tables.packs = cut.packs;
  _tables.lattices = _tiles.any() ? _tiles.lattices : _lattices.lattices;
  if (kind == ElementKind::one_point) {
    std::vector<CongruentShape> boxes(shapes.size());
    for (std::size_t b = 0; b < shapes.size(); ++b)
      if (shapes[b].congruent)
        boxes[b] = CongruentShape::of(shapes[b].jacobian);
    _tables.boxes = toDevice(space, "mechanics::InternalForce::boxes", boxes);
    storeGeometry<OnePointGeometry<double>>(space, cut.num_geometry_rows, _tables);
  } else {
    std::vector<FullGeometry<double>> full(shapes.size());
    for (std::size_t b = 0; b < shapes.size(); ++b)
      if (shapes[b].congruent)
        full[b] = fullShape(shapes[b].jacobian);
    _tables.full_shapes = toDevice(space, "mechanics::InternalForce::full_shapes", full);
    storeGeometry<FullGeometry<double>>(space, cut.num_geometry_rows, _tables);
  }
}

void InternalForce::zeroForces(const exec_space& space, const BulkViscosity& viscosity,
                               const NodalForces& forces) const {
  NodalForces others = forces;
  others.acts[internal_force] = viscosity.any() || !_tiles.any();
  mechanics::zeroForces(space, others);
  if (others.acts[internal_force])
    return;
  const auto nodes = _tiles.seam_nodes;
  const auto values = forces.values;
  Kokkos::parallel_for(
      "mechanics::InternalForce::zeroForces", rangePolicy(space, nodes.extent(0)),
      KOKKOS_LAMBDA(const std::int64_t k) {
        for (int i = 0; i < 3; ++i)
          values(nodes(k), 3 * internal_force + i) = 0;
      });
}

InternalForceResult InternalForce::add(const exec_space& space,
                                       const View<const double* [3]>& displacement,
                                       const NodalForces& forces, bool with_energy) {
  return add(space, displacement, {}, {}, forces, with_energy);
}

InternalForceResult InternalForce::add(const exec_space& space,
                                       const View<const double* [3]>& displacement,
                                       const View<const double* [3]>& velocity,
                                       const BulkViscosity& viscosity, const NodalForces& forces,
                                       bool with_energy) {
  launch(space, displacement, velocity, viscosity, forces, with_energy);
  return result(space);
}

void InternalForce::launch(const exec_space& space, const View<const double* [3]>& displacement,
                           const View<const double* [3]>& velocity, const BulkViscosity& viscosity,
                           const NodalForces& forces, bool with_energy) {
  if (viscosity.any() && static_cast<int>(forces.values.extent(1)) != numForceColumns(true))
    throw Error(ExitCode::internal, "InternalForce::add: viscosity without columns for its force");
  _with_energy = with_energy;
  const bool skips_lattices = !viscosity.any() && !hostLattices().empty();
  ForceArguments arguments{_tables,     displacement,     velocity,      forces.values,
                           viscosity,   _quantum.inverse, _energy_scale, 0,
                           with_energy, skips_lattices,   _is_resting};
  for (const ChunkGroup& group : _groups) {
    if (skips_lattices && _all_in_lattices)
      break;
    arguments.first_chunk = group.first;
    addPackForces(space, _kind, group, arguments, _sums);
  }
  if (skips_lattices && _tiles.any())
    addTileForces(space, _tiles, arguments, _sums);
  else if (skips_lattices)
    _lattice_sums = addLatticeForces(space, _lattices, _slabs, arguments);
}

InternalForceResult InternalForce::result(const exec_space& space) {
  ForceSums sums = _sums.read(space);
  sums += _lattice_sums;
  _lattice_sums = ForceSums();
  InternalForceResult result;
  result.has_energy = _with_energy;
  result.energy = sums.energy;
  result.failure = sums.failure;
  result.compression_rate = sums.compression_rate;
  result.energy.carry();
  return result;
}

std::int64_t InternalForce::numLatticeElems() const {
  std::int64_t count = 0;
  for (const BrickLattice& lattice : hostLattices())
    count += lattice.numElems();
  return count;
}

void InternalForce::skipLattices(const exec_space& space, const std::vector<int>& free_lattices) {
  std::vector<int> others;
  for (int row = 0; row < static_cast<int>(_lattices.on_host.size()); ++row)
    if (std::find(free_lattices.begin(), free_lattices.end(), row) == free_lattices.end())
      others.push_back(row);
  const auto slabsOf = [&](const std::string& name, const std::vector<int>& rows) {
    return toDevice(space, "mechanics::InternalForce::" + name,
                    cutIntoSlabs(_lattices.on_host, rows, _threads));
  };
  _slabs = slabsOf("slabs", others);
  _skipped_slabs = slabsOf("skipped_slabs", free_lattices);
}

void InternalForce::addSkippedLattices(const exec_space& space,
                                       const View<const double* [3]>& displacement,
                                       const NodalForces& forces) const {
  addLatticeForces(space, _lattices, _skipped_slabs,
                   {_tables,
                    displacement,
                    {},
                    forces.values,
                    {},
                    _quantum.inverse,
                    _energy_scale,
                    0,
                    false,
                    true});
}

void InternalForce::computeFields(const exec_space& space,
                                  const View<const double* [3]>& displacement,
                                  ElementFields& fields) const {
  growTo(space, fields.stress, _tables.num_elems);
  growTo(space, fields.pressure, _tables.num_elems);
  growTo(space, fields.stored_energy, _tables.num_elems);
  growTo(space, fields.energy_density, _tables.num_elems);
  const auto num_chunks = static_cast<std::int64_t>(_tables.chunks.extent(0));
  if (_kind == ElementKind::one_point)
    Kokkos::parallel_for("mechanics::InternalForce::computeFields::one_point",
                         rangePolicy(space, num_chunks),
                         FieldFunctor<ElementKind::one_point>{_tables, displacement, fields});
  else
    Kokkos::parallel_for("mechanics::InternalForce::computeFields::full",
                         rangePolicy(space, num_chunks),
                         FieldFunctor<ElementKind::full>{_tables, displacement, fields});
}

} // namespace brickwall::mechanics
