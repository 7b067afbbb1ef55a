// Contact pressure at nodes: normal force over the area on which it acts.
#pragma once

#include "miniapp/simulation/simulation.hpp"

#include <vector>

namespace brickwall::miniapp {

// p = |F|^2 / sum of max(0, -F.a), with the normal contact force F of the node and the areas a =
// integral N dA of the faces around it, outward and deformed. A body under uniform pressure has that
// pressure at all nodes pressed, also where it is pressed on several sides; faces along F do not
// count. [mesh node], the same bits on all ranks that share it; 0 without contact. Collective.
std::vector<double> contactPressure(Simulation& simulation, mechanics::SharedNodeSum& shared);

} // namespace brickwall::miniapp
