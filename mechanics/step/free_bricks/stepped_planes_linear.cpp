#include "mechanics/step/free_bricks/stepped_planes.hpp"

namespace brickwall::mechanics {

template void sweepModel<MaterialModel::linear>(const BrickLattice&, const LatticeSlab&,
                                                const ForceArguments&, double*, ForceSums&,
                                                SteppedPlanes<simd_width>&);

} // namespace brickwall::mechanics
