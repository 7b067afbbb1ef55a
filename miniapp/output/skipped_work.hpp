// What a scene did not need and was therefore left out: the list that `brickwall check` and the report show. The key of a part puts
// it back, for measurements (./run.sh --study savings).
#pragma once

#include "miniapp/deck/config.hpp"
#include "miniapp/output/report.hpp"
#include "miniapp/simulation/diagnostics.hpp"

#include <vector>

namespace brickwall::miniapp {

// Collective. Before the first step what is known of the scene, later what the steps so far have skipped. `counts` are those of
// the simulation.
std::vector<SparedReport> sparedParts(const Config& config, const Simulation& simulation,
                                      const ContactCounts& counts, std::int64_t num_elems);

} // namespace brickwall::miniapp
