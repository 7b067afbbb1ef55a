// Planes of a lattice for InternalForce: displacements are read, and forces are added to the nodal
// forces. Included by lattice_force*.cpp only.
#pragma once

#include "mechanics/force/lattice/lattice_sweep.hpp"

namespace brickwall::mechanics {

// Implements the `Planes` of lattice_sweep.hpp.
template <int W>
struct ForcePlanes {
  static constexpr bool always_with_energy = false;
  const BrickLattice& lattice;
  const ForceArguments& a;

  void load(int plane, const PlaneBuffers<W>& buffers) const {
    const int nodes = lattice.planeNodes(), first = lattice.first_node + plane * nodes;
    for (int p = 0; p < nodes; p += W) {
      PackOf<W> u[3];
      loadSomeTriples(&a.displacement(first + p, 0), nodes - p, u);
      for (int axis = 0; axis < 3; ++axis)
        storePack(u[axis], buffers.displacement(plane, axis) + p);
    }
  }
  void finish(int plane, int p, const IntPackOf<W> (&force)[3]) const {
    const int nodes = lattice.planeNodes(), first = lattice.first_node + plane * nodes + p;
    for (int axis = 0; axis < 3; ++axis) {
      std::int64_t* const to = &a.forces(first, 3 * internal_force + axis);
      storeSome(loadSome<IntPackOf<W>>(to, nodes - p) + force[axis], nodes - p, to);
    }
  }
};

extern template void sweepModel<MaterialModel::neo_hookean>(const BrickLattice&, const LatticeSlab&,
                                                            const ForceArguments&, double*,
                                                            ForceSums&, ForcePlanes<simd_width>&);
extern template void sweepModel<MaterialModel::svk>(const BrickLattice&, const LatticeSlab&,
                                                    const ForceArguments&, double*, ForceSums&,
                                                    ForcePlanes<simd_width>&);
extern template void sweepModel<MaterialModel::linear>(const BrickLattice&, const LatticeSlab&,
                                                       const ForceArguments&, double*, ForceSums&,
                                                       ForcePlanes<simd_width>&);

} // namespace brickwall::mechanics
