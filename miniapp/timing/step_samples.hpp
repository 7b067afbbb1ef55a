// Samples of one quantity, one per step, on this rank; and what they come to over steps and ranks.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

namespace brickwall::miniapp {

// A step counts by its slowest rank.
struct StepStatistics {
  double min = 0, median = 0, max = 0; // over the steps, of the largest sample of all ranks
  double mean = 0; // over steps and ranks
  double imbalance =
      1; // the largest sum over the steps of a rank, over the mean of the ranks' sums; 1 is perfect
};

class StepSamples {
public:
  // Room for so many steps is reserved; the running sum is now at `total`.
  explicit StepSamples(std::int64_t expected_steps, double total = 0);

  // Ends a step: `total` is the running sum of the quantity, the sample what it grew by since the step before.
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
