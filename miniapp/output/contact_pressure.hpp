// Contact pressure at nodes: normal force over the area on which it acts.
#pragma once

#include "miniapp/simulation/simulation.hpp"

#include <vector>

namespace brickwall::miniapp {

// p = |F| / sum of -F.a/|F|, with the normal contact force F of the node and the areas a = integral
// N dA, outward and deformed, of the faces around it that F presses (pressed_cosine; others have no
// load, or one so small that it changes p by less than pressed_cosine^2). Under a uniform pressure
// p is that pressure at all nodes, also where a body is pressed on several sides. [mesh node], the
// same bits on all ranks that share it; 0 without contact. Collective.
std::vector<double> contactPressure(Simulation& simulation, mechanics::SharedNodeSum& shared);

} // namespace brickwall::miniapp
