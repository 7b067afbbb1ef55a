// Watches that no node passes a face unseen: decides which steps to look at, how fast is too fast, and what then.
//
// The boxes of the search are swept over the step, so a node is found before it enters a body, and from then on as long as it
// is not deeper in it than `reach` = node + face tolerance. A node that comes closer to a face by d in each reference step,
// whose length sets the stiffness of contact, gets at most max(2, 1/s) d deep: a free node of s = .5 goes 1.5 d deep, one that is
// pushed by a mesh chi/s d (physics of a penalty s m/dt^2). So contact is sure for d <= `allowed` = reach min(1/2, s).
#pragma once

#include "contact/search/audit/pair_motion.hpp"
#include "mechanics/ledger/ledger_sums.hpp"
#include "miniapp/deck/config.hpp"

#include <string>

namespace brickwall::miniapp {

class TunnellingGuard {
public:
  TunnellingGuard() = default; // off
  // `reach`: the tolerances of the search, added; `reference_step` of contact at the start, which is a stable one.
  TunnellingGuard(const Config& config, double reach, double reference_step);

  // For a kick: counts the nodes that move by more than a third of what is allowed against the mean. If there are none, no
  // pair moves by more than two thirds of what is allowed.
  mechanics::SpeedTest speedTest(const Vec3& mean_velocity) const {
    return {mean_velocity, early_share / 2 * _allowed / _reference_step};
  }

  // Of one node against one face in a step of length dt, length.
  double allowedMotion(double dt) const { return _allowed * (dt / _reference_step); }
  // The motion at which to act. While nothing is in contact a cut costs no energy, and speeds may double in an impact: so then,
  // early, at two thirds of that.
  double tolerableMotion(double dt, bool is_early) const {
    return (actsEarly(is_early) ? early_share : 1) * allowedMotion(dt);
  }

  // For a pair that moves by more than that in a step of dt: shortens the reference step so that it moves by 3/4 of what is
  // allowed in it (.6, early), and returns the step, dt or less, in which it moves by half (.4). Throws PhysicsError, naming
  // the pair, where the deck says so or where the step would be shorter than 1/1000 of the stable one. `step` and `time` are
  // those of the positions before the drift.
  double shorten(double dt, const contact::PairMotion& pair, bool is_early, std::int64_t step,
                 double time);

  // dt_ref of contact, >= every step to come.
  double referenceStep() const { return _reference_step; }

private:
  bool actsEarly(bool is_early) const { return is_early && _action == GuardAction::cut; }

  static constexpr double early_share = 2.0 / 3;
  GuardAction _action = GuardAction::off;
  double _allowed = HUGE_VAL; // in a reference step
  double _reference_step = 1, _shortest_step = 0;
};

} // namespace brickwall::miniapp
