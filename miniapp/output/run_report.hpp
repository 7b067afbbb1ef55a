// Fills the report of a run from its simulation.
#pragma once

#include "contact/base/messages/message_path.hpp"
#include "miniapp/output/report.hpp"
#include "miniapp/simulation/diagnostics.hpp"
#include "miniapp/timing/phase_recorder.hpp"

namespace brickwall::miniapp {

// All but the name of the case, the number of searches within the timed steps, and the warnings and
// failures of the time loop; the warnings and failures of judgeNumbers are included. Collective.
RunReport runReport(MPI_Comm comm, const Config& config, const Scene& scene,
                    const Simulation& simulation, const PhaseRecorder& recorder);

// Adds the warnings and failures that follow from the numbers alone: lost contacts, missed pairs.
void judgeNumbers(RunReport& report);

// Collective. Peak resident memory of the largest rank so far, bytes.
std::int64_t peakRankBytes(MPI_Comm comm);

// This rank's countsOfRank() and its seconds since the first step in search, enforcement and
// distribution of contact and in the rest of the steps, waits for other ranks excluded; and the
// first three together with these waits. The same entries on all ranks.
std::vector<RankValue> loadOfRank(const Simulation& simulation, const PhaseRecorder& recorder);

// Adds to `over_ranks` the messages and bytes that a rank has sent in a counted step, if some were
// counted; `before` is messagesSent() when the first of them began. Collective.
void addMessages(MPI_Comm comm, const MessageCounts& before, RunReport& report);

// Collective. Gives the texts and numbers of report.json to Adiak, for tools such as Caliper; does
// nothing without the option BRICKWALL_ADIAK of CMake.
void giveToAdiak(MPI_Comm comm, const RunReport& report);

} // namespace brickwall::miniapp
