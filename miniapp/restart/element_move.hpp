// Elements move to other ranks during a run: a restart from memory.
#pragma once

#include "miniapp/simulation/simulation.hpp"

#include <memory>
#include <vector>

namespace brickwall::miniapp {

// The simulation, between steps, with each element of this rank on the rank rank_of_elem[elem].
// `scene`, that of the simulation, becomes that of the new parts; its warnings stay. The observer
// is lost, and forces are not there before the next step, as after a restart. Collective. Cost:
// that of the set-up of a run, without reading the mesh.
std::unique_ptr<Simulation> moveElements(std::unique_ptr<Simulation> simulation, Scene& scene,
                                         const std::vector<int>& rank_of_elem);

} // namespace brickwall::miniapp
