// Counts that ranks reduce together with the sums of a step (mechanics::StepCounts::host).
#pragma once

#include "mechanics/ledger/ledger_sums.hpp"

namespace brickwall::miniapp {

enum HostCount : int {
  // numbers of ranks whose penetration exceeds a limit
  deeper_than_warned,
  deeper_than_allowed,
  deeper_than_boxes,
  // numbers of ranks that ask for these: see Requests
  stop_requests,
  checkpoint_requests,
  active_contacts // contacts under load
};
static_assert(active_contacts < mechanics::num_host_counts);

// What a rank, or all of them together, ask for in a step: a signal has arrived, or time is up.
struct Requests {
  bool stop = false; // end the run after this step
  bool checkpoint = false; // write a checkpoint after this step
};

} // namespace brickwall::miniapp
