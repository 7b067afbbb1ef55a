// Samples of one quantity, one per step, on this rank, and their statistics over steps and ranks.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

namespace brickwall::miniapp {

// The value of a step is that of its slowest rank.
struct StepStatistics {
  double min = 0, median = 0, max = 0; // over the steps, of the largest sample of all ranks
  double mean = 0; // over steps and ranks
  // Largest over mean of the ranks' sums over the steps; 1: perfect balance.
  double imbalance = 1;
};

class StepSamples {
public:
  // Reserves memory for so many steps; the running sum starts at `total`.
  explicit StepSamples(std::int64_t expected_steps, double total = 0);

  // Ends a step: `total` is the running sum of the quantity, the sample is its growth since the
  // step before.
  void endStep(double total);
  // Forgets all samples; running sums start from 0.
  void reset();

  // Collective. Over the steps that all ranks have ended; all 0 (imbalance 1) without any.
  StepStatistics statistics(MPI_Comm comm) const;

private:
  double _before = 0;
  std::vector<double> _samples;
};

} // namespace brickwall::miniapp
