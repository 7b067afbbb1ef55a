// Rows of candidates that need not be read again: all their contacts persisted on own faces in the
// last step, no candidate is of another side, and no search has changed the row since.
#pragma once

#include "contact/surface/seen_rows.hpp"

namespace brickwall::contact {

// For kernels.
struct SteadyFlags {
  View<int*> last_step; // [node] the last step in which its row was noted and not forgotten, or 0
  View<const unsigned char*> changed; // [block], see CandidatePairs; empty if no row has changed
  int step = 0; // number of this step
  bool are_known = false; // otherwise rows may have changed

  KOKKOS_FORCEINLINE_FUNCTION bool isSteady(std::int64_t row, int node) const {
    return are_known && last_step(node) == step - 1 &&
           (changed.extent(0) == 0 || changed(row / CandidatePairs::rows_per_block) == 0);
  }
  // Notes a row that is steady if its contacts persist in this step; forget() is for those that may
  // not persist.
  KOKKOS_FORCEINLINE_FUNCTION void note(int node) const { last_step(node) = step; }
  KOKKOS_FORCEINLINE_FUNCTION void forget(int node) const { last_step(node) = 0; }
};

class SteadyRows {
public:
  SteadyRows() = default;
  SteadyRows(const std::string& label, int num_nodes)
      : _last_step(label + "::steady_rows", num_nodes) {}

  // To be called once a step, with its number.
  SteadyFlags flags(const CandidatePairs& pairs, int step) {
    const SeenRows::Comparison rows = _seen.see(pairs);
    SteadyFlags flags{_last_step, {}, step, rows.are_known && _last_step.extent(0) > 0};
    if (!rows.are_same)
      flags.changed = pairs.changed;
    return flags;
  }

private:
  View<int*> _last_step;
  SeenRows _seen;
};

} // namespace brickwall::contact
