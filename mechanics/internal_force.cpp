#include "mechanics/internal_force.hpp"

#include "contact/base/error.hpp"
#include "contact/base/mpi.hpp"
#include "mechanics/element_fields_kernel.hpp"
#include "mechanics/host_mesh.hpp"
#include "mechanics/internal_force_kernel.hpp"
#include "mechanics/viscous_force.hpp"

namespace brickwall::mechanics {

double forceScale(const exec_space& space, MPI_Comm comm, const HexMesh& mesh) {
  const MeshViews m = viewsOf(mesh);
  double largest = 0;
  Kokkos::parallel_reduce(
      "mechanics::forceScale::elements", over(space, mesh.num_elems),
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
  Kokkos::deep_copy(space, forces.values, std::int64_t(0));
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
                             ElementKind kind, Quantum quantum, LimbScale energy_scale, int threads)
    : _kind(kind), _quantum(quantum), _energy_scale(energy_scale) {
  const std::vector<BodyShape> shapes = markCongruentBodies(space, comm, mesh);
  const ElementChunks cut =
      cutIntoChunks(space, mesh, shapes, threads > 0 ? threads : concurrency(space));
  _groups = cut.groups;
  _num_congruent_elems = countCongruent(mesh, shapes);
  _tables.mesh = viewsOf(mesh);
  _tables.num_elems = mesh.num_elems;
  _tables.chunks = cut.chunks;
  _tables.packs = cut.packs;
  if (kind == ElementKind::one_point) {
    std::vector<TlpsBox> boxes(shapes.size());
    for (std::size_t b = 0; b < shapes.size(); ++b)
      if (shapes[b].congruent)
        boxes[b] = tlpsBox(shapes[b].jacobian);
    _tables.boxes = copyToDevice(space, "mechanics::InternalForce::boxes", boxes);
    storeGeometry<TlpsGeometry<double>>(space, cut.num_geometry_rows, _tables);
  } else {
    std::vector<FullGeometry<double>> full(shapes.size());
    for (std::size_t b = 0; b < shapes.size(); ++b)
      if (shapes[b].congruent)
        full[b] = fullShape(shapes[b].jacobian);
    _tables.full_shapes = copyToDevice(space, "mechanics::InternalForce::full_shapes", full);
    storeGeometry<FullGeometry<double>>(space, cut.num_geometry_rows, _tables);
  }
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
  if (viscosity.any() && static_cast<int>(forces.values.extent(1)) != numForceColumns(true))
    throw Error(ExitCode::internal, "InternalForce::add: viscosity without columns for its force");
  InternalForceResult result;
  result.has_energy = with_energy;
  for (const ChunkGroup& group : _groups) {
    const ForceArguments arguments{_tables,       displacement, velocity,
                                   forces.values, viscosity,    _quantum.inverse,
                                   _energy_scale, group.first,  with_energy};
    const ForceSums sums = viscosity.any() ? addWithViscosity(space, _kind, group, arguments)
                                           : launchForces<false>(space, _kind, group, arguments);
    result.energy += sums.energy;
    result.failure += sums.failure;
    result.compression_rate = maxOf(result.compression_rate, sums.compression_rate);
  }
  return result;
}

void InternalForce::computeFields(const exec_space& space,
                                  const View<const double* [3]>& displacement,
                                  ElementFields& fields) const {
  growTo(space, fields.stress, _tables.num_elems);
  growTo(space, fields.pressure, _tables.num_elems);
  growTo(space, fields.energy_density, _tables.num_elems);
  const auto num_chunks = static_cast<std::int64_t>(_tables.chunks.extent(0));
  if (_kind == ElementKind::one_point)
    Kokkos::parallel_for("mechanics::computeFields::one_point", over(space, num_chunks),
                         FieldFunctor<ElementKind::one_point>{_tables, displacement, fields});
  else
    Kokkos::parallel_for("mechanics::computeFields::full", over(space, num_chunks),
                         FieldFunctor<ElementKind::full>{_tables, displacement, fields});
}

} // namespace brickwall::mechanics
