#include "mechanics/ledger/turned_rounding.hpp"

#include "contact/base/mpi.hpp"
#include "mechanics/element/displacement_gradient.hpp"

#include <cmath>

namespace brickwall::mechanics {

namespace {

enum TurnedTerm : int { turned_energy, turned_inertia, num_turned_terms };
using TurnedSums = LimbSums<num_turned_terms>;

constexpr double unit = 0x1p-52;

// |du/dX|^2 at the centre.
KOKKOS_INLINE_FUNCTION double squaredGradient(const CornerCoordinates& X,
                                              const CornerCoordinates& u) {
  const Mat3 H = displacementGradient(X, u);
  double square = 0;
  for (int k = 0; k < 9; ++k)
    square += H(k / 3, k % 3) * H(k / 3, k % 3);
  return square;
}

} // namespace

void raiseNoiseFloorForRotation(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                                const View<const double* [3]>& displacement, LedgerScales& scales) {
  const MeshViews m = viewsOf(mesh);
  const LedgerScales s = scales;
  TurnedSums sums;
  Kokkos::parallel_reduce(
      "mechanics::raiseNoiseFloorForRotation::elements", rangePolicy(space, mesh.num_elems),
      KOKKOS_LAMBDA(const std::int64_t elem, TurnedSums& all) {
        const Material material = m.materials(m.elem_block(elem));
        if (material.model != MaterialModel::neo_hookean)
          return;
        CornerCoordinates X, u;
        gatherCorners(m.elem_to_nodes, m.reference_coordinates, static_cast<int>(elem), X);
        gatherCorners(m.elem_to_nodes, displacement, static_cast<int>(elem), u);
        const double square = squaredGradient(X, u);
        if (!(square > 0))
          return;
        const double size = std::sqrt(square), volume = hexVolume(X).volume;
        Vec3 centre;
        for (int c = 0; c < 8; ++c)
          for (int i = 0; i < 3; ++i)
            centre[i] += 0.125 * (X[c][i] + u[c][i]);
        all.add(turned_energy, unit * material.mu() * volume * (size + square + size * square),
                s.energy);
        all.add(turned_inertia, material.density * volume * dot(centre, centre), s.inertia);
      },
      PlusReducer<TurnedSums>(sums));
  allReduce(comm, sums);
  const double energy = energies_over_rounding * sums.sum[turned_energy].value(scales.energy);
  const double inertia = sums.sum[turned_inertia].value(scales.inertia);
  scales.noise = maxOf(scales.noise, energy);
  scales.angular_noise = maxOf(scales.angular_noise, std::sqrt(2 * energy * inertia));
}

} // namespace brickwall::mechanics
