// Phase times from profiling regions: the recorder uses the region callbacks of Kokkos, so that the
// solver contains no timer calls. The stages of a step open regions "miniapp::<function>", a search
// opens "contact::search", and in it the 13 timers of Fig. 11 of the paper (searchTimerRegion).
#pragma once

#include "miniapp/timing/region_tree.hpp"
#include "miniapp/timing/step_samples.hpp"

#include <mpi.h>

#include <cstdint>
#include <string>
#include <vector>

namespace brickwall::miniapp {

// One phase over all ranks; calls and seconds of a rank are sums over all calls.
struct PhaseTime {
  std::string name;
  std::int64_t calls = 0; // largest number of all ranks
  double min = 0, mean = 0, max = 0; // seconds
};

// A phase's seconds and CPU seconds per step over all ranks.
struct PhaseSteps {
  std::string name;
  StepStatistics seconds, cpu_seconds;
};

// Accumulates calls and seconds per region on this rank. At most one recorder exists at a time; it
// is installed by its constructor (after Kokkos::initialize) and removed by its destructor; tools
// that were loaded earlier still receive every call. Regions are opened by one thread only. Nothing
// is allocated once every region has been seen.
class PhaseRecorder {
public:
  // With Timing::paper the beginning of each timer of the search fences the device and waits for
  // all ranks of `comm` (counted as "contact::search::waiting"), and its end fences: every rank
  // must then open the same regions of this kind in the same order.
  PhaseRecorder(MPI_Comm comm, Timing timing);
  ~PhaseRecorder();
  PhaseRecorder(const PhaseRecorder&) = delete;
  PhaseRecorder& operator=(const PhaseRecorder&) = delete;

  // Forgets all calls, seconds and samples: the first step is not counted. Open regions count
  // from this point.
  void reset();

  // Seconds and calls of all regions of that name on this rank, nested regions included.
  double seconds(const std::string& region) const;
  std::int64_t calls(const std::string& region) const;
  // seconds() less those in which this rank waits for others.
  double busySeconds(const std::string& region) const;

  // Keeps one sample per step of the region's seconds; `expected_steps` are reserved. Same on all
  // ranks.
  void watch(const std::string& region, std::int64_t expected_steps);
  // The same of the CPU seconds that all threads of this process spend in these regions, less those
  // in "contact::search::waiting". Once, with no region open.
  void watchCpu(const std::vector<std::string>& regions, std::int64_t expected_steps);
  // The same of the own seconds of each of the 13 timers; their CPU seconds are counted with
  // Timing::paper only, after watchCpu().
  void watchSearchTimers(std::int64_t expected_steps);
  // Ends a step: takes one sample of each watched region.
  void endStep();

  // Collective. Statistics of a watched region.
  StepStatistics secondsPerStep(const std::string& region) const;
  StepStatistics busyCpuPerStep(const std::string& region) const;
  double medianPerStep(const std::string& region) const { return secondsPerStep(region).median; }
  // Collective. The 13 timers in the order of the paper, by their bare names; empty when they are
  // not watched.
  std::vector<PhaseSteps> searchTimersPerStep() const;

  // Collective. All regions by name, "contact::search" and the 13 timers included, that with the
  // largest mean time first.
  std::vector<PhaseTime> phases() const;
  // Collective. The 13 timers of the global search in the order of the paper, by their bare names;
  // unused timers are 0; "other" is the rest of "contact::search" without the local search. Each
  // excludes the timers nested in it, so that they add up.
  std::vector<PhaseTime> searchTimers() const;

  struct State; // for the callbacks

private:
  State* _state;
};

} // namespace brickwall::miniapp
