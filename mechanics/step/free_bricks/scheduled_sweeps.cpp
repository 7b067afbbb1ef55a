// The sweep over bricks of neo-Hookean boxes along the axes, in a file of its own for its flags: g++ is to reorder before it
// assigns registers (mechanics/CMakeLists.txt), so that other work stands between the steps of the division and the
// logarithm. That is 5 % faster; the other sweeps lose by it, since they spill more.
#include "mechanics/step/free_bricks/stepped_planes.hpp"

namespace brickwall::mechanics {

namespace {

// Devices have no packs.
template <int W, class Sweep, class Planes>
void runInLanes(Sweep& sweep, const LatticeSlab& slab, Planes& planes) {
  if constexpr (W > 1)
    sweep.run(slab, planes);
}

} // namespace

void runSweep(LatticeSweep<MaterialModel::neo_hookean, SharedShape<OnePointBrick>, 8>& sweep,
              const LatticeSlab& slab, SteppedPlanes<8>& planes) {
  runInLanes<simd_width>(sweep, slab, planes);
}

} // namespace brickwall::mechanics
