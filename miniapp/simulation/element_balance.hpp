// Which ranks hold which elements (partition.rebalance), and when that changes. No bit of the
// results depends on it.
#pragma once

#include "miniapp/simulation/simulation.hpp"

#include <mpi.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace brickwall::miniapp {

// Elements have moved to other ranks.
struct Rebalancing {
  std::int64_t step = 0; // after which they moved
  double seconds = 0; // that it took, on the slowest rank
  // Largest over mean of the work of the ranks in the checks before and after it; 0: no check
  // since.
  double imbalance_before = 0, imbalance_after = 0;
};

// Time since any moment on this rank, seconds.
struct PartSeconds {
  double step = 0; // whole steps
  double elements = 0; // internal forces and kicks, which wait for no other rank
  double contact = 0; // search and enforcement with their waits
};

// Work of a rank in seconds of the time since the last check: its moving elements at the mean time
// of an element on all ranks, and the work of contact on their faces (ContactStep::workOfFaces())
// at the least time per work of all ranks, which is that of the rank that waited least.
class ElementBalance {
public:
  // Of an element at rest over that of a moving one. It takes no time, but memory, and may start to
  // move.
  static constexpr double work_at_rest = 0.1;

  // `cost`: seconds that a rebalancing takes, an estimate of this rank.
  ElementBalance(MPI_Comm comm, const PartitionConfig& config, double cost)
      : _comm(comm), _config(config), _decision(comm, cost) {}

  // The rank on which each element of this rank is to be, [elem], if elements are to move before
  // the next step: by recursive coordinate bisection of their present centroids. `now` has grown by
  // the steps of `simulation` since the last call. Between steps; collective.
  std::optional<std::vector<int>> newRanks(Simulation& simulation, const PartSeconds& now);
  // To be called after each move, which took `seconds` on the slowest rank; `now` as above, without
  // that time.
  void haveMoved(double seconds, const PartSeconds& now);

  const std::vector<Rebalancing>& rebalancings() const { return _rebalancings; }

private:
  std::vector<float> workOfElements(Simulation& simulation, const PartSeconds& spent,
                                    double& work) const;

  MPI_Comm _comm;
  PartitionConfig _config;
  ContactBalance _decision; // the rule by which faces of contact move
  double _expected_imbalance = 1; // after the last move
  PartSeconds _before; // in the last check, or after the last move
  std::vector<Rebalancing> _rebalancings;
};

} // namespace brickwall::miniapp
