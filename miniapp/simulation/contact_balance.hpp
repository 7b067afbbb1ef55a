// Which ranks search and enforce which faces (search.decomposition), and when that changes. No bit
// of the results depends on it.
#pragma once

#include "contact/surface/surface.hpp"
#include "miniapp/deck/config.hpp"

#include <mpi.h>

#include <cmath>
#include <cstdint>
#include <vector>

namespace brickwall::miniapp {

// The largest over the mean of all ranks. Collective.
double imbalanceOf(MPI_Comm comm, double work);
// The same after a distribution: of the sums of `work` [face] on the ranks `rank_of_face` [face].
double imbalanceOf(MPI_Comm comm, const std::vector<float>& work,
                   const std::vector<int>& rank_of_face);

// The rank on which each face of this rank is to be, [face], such that the sums of `work` [face]
// are about equal and ranks are compact: recursive coordinate bisection. Collective.
std::vector<int> balancedRanks(MPI_Comm comm, const contact::Surface& surface,
                               const std::vector<float>& work);

// Decides when faces are distributed anew: as soon as the time that another distribution would have
// saved since the last one exceeds the time that it takes. Time is expected to be in proportion to
// the largest work of a rank, and away from their home ranks to the overhead of messages besides.
// The first check after faces have left home measures whether that was right. If not, they return,
// and leave again only for a larger imbalance; the second time they return for good.
class ContactBalance {
public:
  static constexpr std::int64_t check_interval = 10; // steps
  // An imbalance that is tolerated, and the least gain for which faces stay away from home.
  static constexpr double tolerated = 1.1;

  // Time for equal work away from home over that at home; 1.0 to 1.3 in
  // verification/performance/balance/.
  static constexpr double usual_overhead = 1.3;

  // `cost`: seconds that a distribution takes, an estimate of this rank.
  ContactBalance(MPI_Comm comm, double cost, double overhead = 1)
      : _comm(comm), _cost(cost), _overhead(overhead) {}

  void addTime(double seconds) { _time += seconds; } // that contact took on this rank
  // Whether to distribute now. `work` is that of this rank in the last step, `work_at_home` what it
  // would be with all faces at home; both are the same where faces have no home or areHome().
  // Collective, every check_interval steps.
  bool isDue(double work, double work_at_home);
  bool areHome() const { return _are_home; }
  // After isDue(): whether faces are to return home.
  bool isHomeBetter() const { return _at_home <= tolerated * _overhead; }
  double imbalance() const { return _imbalance; } // of the work at the last isDue()
  double overhead() const { return _overhead; } // assumed; grows where faces leave home in vain
  // To be called after each distribution, which took `seconds` on this rank. It leaves this
  // imbalance, or has brought all faces home. Elements have no other home than their ranks.
  void haveDistributed(double seconds, double imbalance, bool are_home = true);
  void haveReturned(double seconds) { haveDistributed(seconds, 0); }

  // since the start or the restart
  std::int64_t distributions() const { return _distributions; }

private:
  MPI_Comm _comm;
  double _cost; // seconds
  double _time = 0; // of contact since the last check, seconds
  double _lost = 0; // by waits since the last distribution, seconds
  double _imbalance = 1, _at_home = 1; // at the last check: as faces are, and with all at home
  double _reached = tolerated; // imbalance after the last distribution, if larger
  bool _are_home = true;
  // seconds for a unit of the largest work at home, when faces were there last
  double _rate_at_home = 0;
  double _overhead;
  bool _is_measured = true; // since faces left home
  bool _has_failed = false; // faces have left home in vain
  std::int64_t _distributions = 0;
};

} // namespace brickwall::miniapp
