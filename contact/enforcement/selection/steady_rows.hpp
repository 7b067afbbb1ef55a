// Rows of candidates that need not be read again: the last search left them as they were, their
// contacts persisted on their faces in the last step, and no candidate is of another body.
#pragma once

#include "contact/surface/surface.hpp"

namespace brickwall::contact {

// For kernels.
struct SteadyFlags {
  View<int*> step_of_node; // [node] the last step after which its row was steady, or 0
  View<const unsigned char*> changed; // [block], see CandidatePairs; empty if no row has changed
  int step = 0; // number of this step
  bool are_known = false; // otherwise no row is known to be as in the last step

  KOKKOS_FORCEINLINE_FUNCTION bool isSteady(std::int64_t row, int node) const {
    return are_known && step_of_node(node) == step - 1 &&
           (changed.extent(0) == 0 || changed(row / CandidatePairs::rows_per_block) == 0);
  }
  KOKKOS_FORCEINLINE_FUNCTION void note(int node) const { step_of_node(node) = step; }
};

class SteadyRows {
public:
  SteadyRows() = default;
  SteadyRows(const std::string& label, int num_nodes) : _steps(label + "::steady_in", num_nodes) {}

  // To be called once a step, with its number.
  SteadyFlags flags(const CandidatePairs& pairs, int step) {
    const bool are_same = pairs.version == _version, are_next = pairs.version == _version + 1;
    SteadyFlags flags{_steps, {}, step, false};
    flags.are_known = pairs.version > 0 && _changed == pairs.changed.data() &&
                      _steps.extent(0) > 0 && (are_same || are_next);
    if (!are_same)
      flags.changed = pairs.changed;
    _version = pairs.version;
    _changed = pairs.changed.data();
    return flags;
  }

private:
  View<int*> _steps;
  std::int64_t _version = 0; // of the pairs of the last step
  const unsigned char* _changed = nullptr; // likewise
};

} // namespace brickwall::contact
