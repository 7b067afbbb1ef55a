// From a simulation that has ended to the report of its run.
#pragma once

#include "miniapp/output/report.hpp"
#include "miniapp/simulation/diagnostics.hpp"
#include "miniapp/timing/phase_report.hpp"

namespace brickwall::miniapp {

// All but the case's name, the searches within the timed steps and what the time loop alone knows of warnings and failures; what the figures say for themselves (lost
// contacts, missed pairs) is among them. Collective.
RunReport runReport(MPI_Comm comm, const Config& config, const Scene& scene,
                    const Simulation& simulation, const PhaseRecorder& recorder);

} // namespace brickwall::miniapp
