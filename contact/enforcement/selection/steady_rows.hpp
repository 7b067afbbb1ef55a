// Rows of candidates that need not be read again: all their contacts persisted on own faces in the
// last step, no candidate is of another body, and no search has changed the row since.
#pragma once

#include "contact/surface/surface.hpp"

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
    const bool are_same = pairs.version == _version, are_next = pairs.version == _version + 1;
    SteadyFlags flags{_last_step, {}, step, false};
    flags.are_known = _last_step.extent(0) > 0 && _version > 0 && (are_same || are_next) &&
                      pairs.changed.data() == _changed;
    if (!are_same)
      flags.changed = pairs.changed;
    _version = pairs.version;
    _changed = pairs.changed.data();
    return flags;
  }

private:
  View<int*> _last_step;
  std::int64_t _version = 0; // of the pairs of the last step
  const unsigned char* _changed = nullptr; // likewise
};

} // namespace brickwall::contact
