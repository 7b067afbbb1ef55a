// Steps of free bricks of the St. Venant-Kirchhoff material. A unit of its own, as all models are.
#include "mechanics/step/free_bricks/stepped_planes.hpp"

namespace brickwall::mechanics {

template void sweepModel<MaterialModel::svk>(const BrickLattice&, const LatticeSlab&,
                                             const ForceArguments&, double*, ForceSums&,
                                             SteppedPlanes<simd_width>&);

} // namespace brickwall::mechanics
