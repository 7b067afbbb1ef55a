#include "miniapp/timing/step_samples.hpp"

#include "contact/base/mpi.hpp"

#include <algorithm>
#include <numeric>

namespace brickwall::miniapp {
namespace {

double medianOfSorted(const std::vector<double>& sorted) {
  const std::size_t half = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[half] : 0.5 * (sorted[half - 1] + sorted[half]);
}

} // namespace

StepSamples::StepSamples(std::int64_t expected_steps, double total) : _before(total) {
  constexpr std::int64_t most = 1 << 20; // beyond this, the list grows on demand
  _samples.reserve(
      static_cast<std::size_t>(std::min(std::max<std::int64_t>(expected_steps, 16), most)));
}

void StepSamples::endStep(double total) {
  _samples.push_back(total - _before);
  _before = total;
}

void StepSamples::reset() {
  _before = 0;
  _samples.clear();
}

StepStatistics StepSamples::statistics(MPI_Comm comm) const {
  StepStatistics statistics;
  const auto steps = allReduce(comm, static_cast<std::int64_t>(_samples.size()), MPI_MIN);
  if (steps == 0)
    return statistics;
  std::vector<double> slowest(_samples.begin(), _samples.begin() + steps);
  const double own_sum = std::accumulate(slowest.begin(), slowest.end(), 0.0);
  const double mean_sum = allReduce(comm, own_sum, MPI_SUM) / sizeOf(comm);
  const double max_sum = allReduce(comm, own_sum, MPI_MAX);
  allReduce(comm, slowest.data(), checkedInt(steps, "samples of a region"), MPI_MAX);
  std::sort(slowest.begin(), slowest.end());
  statistics.min = slowest.front();
  statistics.median = medianOfSorted(slowest);
  statistics.max = slowest.back();
  statistics.mean = mean_sum / static_cast<double>(steps);
  statistics.imbalance = mean_sum > 0 ? max_sum / mean_sum : 1;
  return statistics;
}

} // namespace brickwall::miniapp
