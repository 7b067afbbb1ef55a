// Prevents nodes from passing through faces undetected: decides which steps to test, which relative
// motion is too fast, and how to respond.
//
// The boxes of the search are swept over the step. A node is therefore found before it enters a
// body, and afterwards as long as it is not deeper in it than `reach` = node + face tolerance. The
// stiffness of contact is s m/dt^2 with the penalty s and the reference step dt. If a node
// approaches a face by d in each reference step, its depth is at most max(2, 1/s) d: a free node
// with s = 0.5 becomes 1.5 d deep, one that is pushed by a mesh chi/s d. Contact is therefore
// reliable for d <= `allowed` = reach min(1/2, s).
#pragma once

#include "contact/search/audit/pair_motion.hpp"
#include "mechanics/ledger/ledger_sums.hpp"
#include "miniapp/deck/config.hpp"
#include "miniapp/scene/entity_names.hpp"

namespace brickwall::miniapp {

class TunnellingGuard {
public:
  TunnellingGuard() = default; // off
  // `reach` is the sum of the tolerances of the search, `reference_step` the reference step of
  // contact at the start, a stable step.
  TunnellingGuard(const Config& config, double reach, double reference_step);

  // For a kick: counts the nodes that move by more than a third of the allowed motion relative to
  // the mean. If there are none, no pair moves by more than two thirds of the allowed motion.
  mechanics::SpeedTest speedTest(const Vec3& mean_velocity) const {
    return {mean_velocity, early_share / 2 * _allowed / _reference_step};
  }

  // Allowed motion of one node relative to one face in a step dt, length.
  double allowedMotion(double dt) const { return _allowed * (dt / _reference_step); }
  // Motion above which the guard acts. While nothing is in contact (`is_early`), a cut costs no
  // energy and speeds may double in an impact: the guard then acts at two thirds of the allowed
  // motion.
  double tolerableMotion(double dt, bool is_early) const {
    return (actsEarly(is_early) ? early_share : 1) * allowedMotion(dt);
  }

  // For a pair that moves by more than tolerableMotion() in a step dt: shortens the reference step
  // so that the pair moves by 3/4 of the allowed motion in it (0.6 if `is_early`), and returns the
  // step, at most dt, in which it moves by half of it (0.4). Throws PhysicsError, naming the pair,
  // if the deck asks for it or if the step would be shorter than 1/1000 of the stable one. `step`
  // and `time` are those of the positions before the drift.
  double shorten(double dt, const contact::PairMotion& pair, bool is_early, std::int64_t step,
                 double time, const EntityNames& names);

  // Reference step of contact; not shorter than any later step.
  double referenceStep() const { return _reference_step; }
  void setReferenceStep(double dt) { _reference_step = dt; } // that of a restart file

private:
  bool actsEarly(bool is_early) const { return is_early && _action == GuardAction::cut; }

  static constexpr double early_share = 2.0 / 3;
  GuardAction _action = GuardAction::off;
  double _allowed = HUGE_VAL; // in a reference step
  double _reference_step = 1, _shortest_step = 0;
  double _penalty = 1;
};

} // namespace brickwall::miniapp
