// Forces of lattices of the St. Venant-Kirchhoff material. A unit of its own, as all models are.
#include "mechanics/force/lattice/force_planes.hpp"

namespace brickwall::mechanics {

template void sweepModel<MaterialModel::svk>(const BrickLattice&, const LatticeSlab&,
                                             const ForceArguments&, double*, ForceSums&,
                                             ForcePlanes<simd_width>&);

} // namespace brickwall::mechanics
