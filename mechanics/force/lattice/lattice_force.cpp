#include "mechanics/force/lattice/lattice_force.hpp"

#include "mechanics/force/lattice/force_planes.hpp"

namespace brickwall::mechanics {

namespace {

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
    sweepSlab(lattice, slab, a, &tables.scratch(thread, 0), sums, planes);
    token.release(thread);
  }
};

template <int W>
ForceSums launch(const exec_space& space, const LatticeTables& tables,
                 const View<LatticeSlab*>& slabs, const ForceArguments& arguments) {
  ForceSums sums;
  if constexpr (W > 1) {
    Kokkos::parallel_reduce("mechanics::InternalForce::add::lattices",
                            dynamicPolicy(space, static_cast<std::int64_t>(slabs.extent(0)), 1),
                            LatticeForceFunctor<W>{tables, slabs, arguments, {}},
                            PlusReducer<ForceSums>(sums));
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
