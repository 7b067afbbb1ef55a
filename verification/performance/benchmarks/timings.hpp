// Repeated timings of one piece of work: their median, least and largest.
#pragma once

#include "contact/base/mpi.hpp"

#include <algorithm>
#include <vector>

namespace brickwall::peers {

class Timings {
public:
  // Collective. Runs `work` after a barrier; keeps the wall-clock time of the slowest rank, in
  // seconds.
  template <class Work>
  void measure(MPI_Comm comm, const Work& work) {
    barrier(comm);
    const double start = MPI_Wtime();
    work();
    _seconds.push_back(allReduce(comm, MPI_Wtime() - start, MPI_MAX));
  }
  void forget() { _seconds.clear(); }

  double median() const {
    std::vector<double> sorted = _seconds;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t n = sorted.size();
    return 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]);
  }
  double shortest() const { return *std::min_element(_seconds.begin(), _seconds.end()); }
  double longest() const { return *std::max_element(_seconds.begin(), _seconds.end()); }

private:
  std::vector<double> _seconds;
};

} // namespace brickwall::peers
