#include "mechanics/force/lattice/lattice_force.hpp"

#include "mechanics/force/lattice/brick_sweep.hpp"

namespace brickwall::mechanics {

namespace {

// Displacements in, forces out.
template <int W>
struct ForcePlanes {
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
    std::int64_t f[3][W];
    for (int axis = 0; axis < 3; ++axis)
      storePack(force[axis], f[axis]);
    for (int lane = 0; lane < minOf(W, nodes - p); ++lane)
      for (int axis = 0; axis < 3; ++axis)
        a.forces(first + lane, 3 * internal_force + axis) += f[axis][lane];
  }
};

template <int W>
struct LatticeForceFunctor {
  LatticeTables tables;
  View<LatticeSlab*> slabs;
  ForceArguments a;
  Kokkos::Experimental::UniqueToken<exec_space> token;

  void operator()(const std::int64_t s, ForceSums& sums) const {
    const LatticeSlab slab = slabs(s);
    const BrickLattice lattice = tables.lattices(slab.lattice);
    if (a.rests(lattice.body))
      return;
    ForcePlanes<W> planes{lattice, a};
    const auto thread = token.acquire();
    sweepSlab<W>(lattice, slab, a, &tables.scratch(thread, 0), sums, planes);
    token.release(thread);
  }
};

template <int W>
ForceSums launch(const exec_space& space, const LatticeTables& tables,
                 const View<LatticeSlab*>& slabs, const ForceArguments& arguments) {
  ForceSums sums;
  if constexpr (W > 1) {
    Kokkos::parallel_reduce("mechanics::internalForce::lattices",
                            dynamicPolicy(space, static_cast<std::int64_t>(slabs.extent(0)), 1),
                            LatticeForceFunctor<W>{tables, slabs, arguments, {}},
                            PlusReducer<ForceSums>(sums));
    space.fence();
  }
  return sums;
}

template <int W>
std::int64_t scratchFor(const std::vector<BrickLattice>& lattices) {
  std::int64_t size = 0;
  if constexpr (W > 1)
    for (const BrickLattice& lattice : lattices)
      size = maxOf(size, PlaneBuffers<W>::sizeFor(lattice));
  return size;
}

} // namespace

std::int64_t latticeScratch(const std::vector<BrickLattice>& lattices) {
  return scratchFor<simd_width>(lattices);
}

ForceSums addLatticeForces(const exec_space& space, const LatticeTables& tables,
                           const View<LatticeSlab*>& slabs, const ForceArguments& arguments) {
  return launch<simd_width>(space, tables, slabs, arguments);
}

} // namespace brickwall::mechanics
