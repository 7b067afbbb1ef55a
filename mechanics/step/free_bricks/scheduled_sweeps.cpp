// The sweep over free bricks of neo-Hookean boxes along the axes, in a file of its own for its
// compile flags: g++ schedules instructions before it assigns registers (mechanics/CMakeLists.txt),
// which fills the latency of the division and the logarithm. This sweep is 5 % faster with them;
// the other sweeps are slower, since they spill more registers.
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

void runSweep(
    LatticeSweep<MaterialModel::neo_hookean, SharedShape<OnePointBrick>, simd_width>& sweep,
    const LatticeSlab& slab, SteppedPlanes<simd_width>& planes) {
  runInLanes<simd_width>(sweep, slab, planes);
}

} // namespace brickwall::mechanics
