// Results of a step's verbs that later verbs, reports and the next step read.
#pragma once

#include "contact/enforcement/enforcement.hpp"
#include "mechanics/force/internal_force.hpp"
#include "mechanics/ledger/ledger_sums.hpp"
#include "mechanics/loads/pulse_shape.hpp"
#include "miniapp/simulation/step_controller.hpp"

namespace brickwall::miniapp {

// Sums and counts are those of this rank.
struct StepState {
  bool is_guarded = false; // some nodes are fast, so the state before the drift is kept
  bool free_bricks_have_drifted = true; // otherwise they drift in kickVelocities()
  bool has_all_forces = true; // false: those of free bricks were not stored
  std::int64_t resting_elems = 0;
  mechanics::InternalForceResult internal;
  mechanics::TimeSpan load_span, previous_load_span; // spans of the last two kicks
  std::int64_t load_failures = 0;
  contact::EnforcementSums contact;
  mechanics::KickSums kick;
};

// The state before a drift that the tunnelling guard may undo.
struct StateBeforeDrift {
  Clock clock;
  View<double* [3]> displacement; // u^n [node][xyz], length
};

} // namespace brickwall::miniapp
