#include "mechanics/mesh/lumped_mass.hpp"

#include "contact/base/mpi.hpp"
#include "mechanics/element/hex8_geometry.hpp"

#include <cfloat>
#include <cmath>

namespace brickwall::mechanics {

namespace {

struct MassCheck {
  double largest = 0; // corner mass
  ElementFailure failure;
  KOKKOS_INLINE_FUNCTION MassCheck& operator+=(const MassCheck& b) {
    largest = maxOf(largest, b.largest);
    failure += b.failure;
    return *this;
  }
};

KOKKOS_INLINE_FUNCTION double cornerMass(const MeshViews& mesh, int elem, HexVolume& volume) {
  CornerCoordinates X;
  gatherCorners(mesh.elem_to_nodes, mesh.reference_coordinates, elem, X);
  volume = hexVolume(X);
  return 0.125 * mesh.materials(mesh.elem_block(elem)).density * volume.volume;
}

// Products of large coordinates are infinite or, as differences, not a number.
KOKKOS_INLINE_FUNCTION int failureReason(const HexVolume& volume, double mass) {
  if (!(std::fabs(mass) <= DBL_MAX))
    return mass_out_of_range;
  if (!(volume.min_determinant > 0))
    return inverted_element;
  return mass > 0 ? no_failure : mass_out_of_range;
}

MassCheck checkMasses(const exec_space& space, const MeshViews& m, int num_elems) {
  MassCheck check;
  Kokkos::parallel_reduce(
      "mechanics::lumpedMass::check", rangePolicy(space, num_elems),
      KOKKOS_LAMBDA(const std::int64_t elem, MassCheck& sum) {
        HexVolume volume;
        const double mass = cornerMass(m, static_cast<int>(elem), volume);
        const int reason = failureReason(volume, mass);
        if (reason == no_failure)
          sum.largest = maxOf(sum.largest, mass);
        else
          sum.failure.add(m.elem_ids(elem), reason);
      },
      PlusReducer<MassCheck>(check));
  return check;
}

void addMasses(const exec_space& space, const MeshViews& m, int num_elems, double inverse_quantum,
               const View<std::int64_t**>& sums) {
  Kokkos::parallel_for(
      "mechanics::lumpedMass::add", rangePolicy(space, num_elems),
      KOKKOS_LAMBDA(const std::int64_t elem) {
        HexVolume volume;
        const std::int64_t mass =
            roundToFixed(inverse_quantum * cornerMass(m, static_cast<int>(elem), volume));
        for (int c = 0; c < 8; ++c)
          Kokkos::atomic_add(&sums(m.elem_to_nodes(elem, c), 0), mass);
      });
}

} // namespace

View<double*> lumpedMass(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                         SharedNodeSum& shared) {
  const MeshViews m = viewsOf(mesh);
  const MassCheck check = checkMasses(space, m, mesh.num_elems);
  const GlobalFailure failure = agreeOnFailure(space, comm, mesh, check.failure);
  if (failure.count > 0)
    throw BadElementError(failure.first_elem,
                          describe(failure) + "; expected J > 0 at all 2x2x2 Gauss points of each "
                                              "element, and a finite mass > 0");
  const double largest = allReduce(comm, check.largest, MPI_MAX);
  const Quantum quantum = largest > 0 ? Quantum::forForceScale(largest) : Quantum::powerOfTwo(0);
  View<std::int64_t**> sums("mechanics::lumpedMass::sums", mesh.num_nodes, 1);
  addMasses(space, m, mesh.num_elems, quantum.inverse, sums);
  shared.sum(space, sums);
  auto mass = allocate<View<double*>>(space, "mechanics::lumpedMass::mass", mesh.num_nodes);
  Kokkos::parallel_for(
      "mechanics::lumpedMass::convert", rangePolicy(space, mesh.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node) {
        mass(node) = quantum.value * static_cast<double>(sums(node, 0));
      });
  space.fence();
  return mass;
}

double totalMass(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                 const View<const double*>& mass) {
  double largest = 0;
  Kokkos::parallel_reduce(
      "mechanics::totalMass::largest", rangePolicy(space, mesh.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node, double& m) { m = maxOf(m, mass(node)); },
      Kokkos::Max<double>(largest));
  // With room for 2^38 nodes.
  const LimbScale scale = LimbScale::forLargest(0x1p10 * allReduce(comm, largest, MPI_MAX));
  const auto is_owned = mesh.node_is_owned;
  LimbSums<1> sum;
  Kokkos::parallel_reduce(
      "mechanics::totalMass::sum", rangePolicy(space, mesh.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node, LimbSums<1>& s) {
        if (is_owned(node))
          s.add(0, mass(node), scale);
      },
      PlusReducer<LimbSums<1>>(sum));
  allReduce(comm, sum);
  return sum.sum[0].value(scale);
}

} // namespace brickwall::mechanics
