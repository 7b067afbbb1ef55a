// The work that a row of candidates was in the last step, for decompositions that balance it.
#pragma once

#include "contact/enforcement/dormancy/idle_rows.hpp"

namespace brickwall::contact {

// Times in search and enforcement, in units of 32 ns of a core: of a face, of a candidate pair that
// is tested, and of a contact, fitted to those of ranks in verification/performance/balance/.
struct WorkUnits {
  static constexpr std::int64_t face = 3, pair = 2, contact = 10;
};

// For kernels, after a step and before the next search. Rows without a test take no time.
struct RowWork {
  CandidatePairs pairs;
  View<const int*> row_count; // [node] contacts
  IdleState idle;

  KOKKOS_INLINE_FUNCTION std::int64_t operator()(std::int64_t row) const {
    const int node = pairs.node(row);
    const StationaryFlags& stationary = idle.stationary;
    const bool is_tested =
        !idle.sleeps(row / CandidatePairs::rows_per_block) &&
        !(stationary.is_any && stationary.nodes(node) && stationary.known_apart(node));
    return WorkUnits::contact * row_count(node) +
           (is_tested ? WorkUnits::pair * (pairs.end(row) - pairs.begin(row)) : 0);
  }
};

} // namespace brickwall::contact
