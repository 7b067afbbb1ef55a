// The work that a scene did not need and that was therefore skipped, as `brickwall check` and the
// report list it. The key of a part makes the program do the work nevertheless, for measurements
// (./run.sh --study savings).
#pragma once

#include "miniapp/deck/config.hpp"
#include "miniapp/output/report.hpp"
#include "miniapp/simulation/diagnostics.hpp"

#include <vector>

namespace brickwall::miniapp {

// Collective. Before the first step the shares follow from the scene, later from the steps so far.
// `counts` are those of the simulation.
std::vector<SkippedPart> skippedWork(const Config& config, const Simulation& simulation,
                                     const ContactCounts& counts, std::int64_t num_elems);

} // namespace brickwall::miniapp
