#include "mechanics/ledger/small_strain.hpp"

#include "contact/base/mpi.hpp"
#include "mechanics/element/displacement_gradient.hpp"

namespace brickwall::mechanics {

NeglectedStrain neglectedStrain(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                                const View<const double* [3]>& displacement) {
  const MeshViews m = viewsOf(mesh);
  NeglectedStrain local;
  Kokkos::parallel_reduce(
      "mechanics::neglectedStrain::elements", rangePolicy(space, mesh.num_elems),
      KOKKOS_LAMBDA(const std::int64_t elem, NeglectedStrain& all) {
        if (m.materials(m.elem_block(elem)).model != MaterialModel::linear)
          return;
        CornerCoordinates X, u;
        gatherCorners(m.elem_to_nodes, m.reference_coordinates, static_cast<int>(elem), X);
        gatherCorners(m.elem_to_nodes, displacement, static_cast<int>(elem), u);
        const Mat3 H = displacementGradient(X, u);
        NeglectedStrain one;
        one.elem = m.elem_ids(elem);
        for (int j = 0; j < 3; ++j)
          one.strain =
              maxOf(one.strain, 0.5 * (H(0, j) * H(0, j) + H(1, j) * H(1, j) + H(2, j) * H(2, j)));
        all += one;
      },
      PlusReducer<NeglectedStrain>(local));
  NeglectedStrain largest;
  largest.strain = allReduce(comm, local.strain, MPI_MAX);
  largest.elem = allReduce(comm, local.strain == largest.strain ? local.elem : INT64_MAX, MPI_MIN);
  return largest;
}

} // namespace brickwall::mechanics
