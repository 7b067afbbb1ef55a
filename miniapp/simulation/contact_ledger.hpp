// Contact's entries in the energy ledger: what springs store, what damping and friction have
// dissipated since the start, and the work of edges.
#pragma once

#include "contact/enforcement/enforcement.hpp"
#include "mechanics/ledger/ledger_sums.hpp"

#include <array>

namespace brickwall::miniapp {

class ContactLedger {
public:
  // This rank's share of the balance after a step's enforcement. The energy that friction has taken
  // from the bodies is partly stored, and the rest is dissipated.
  mechanics::ContactEnergySums add(const contact::EnforcementSums& step) {
    mechanics::ContactEnergySums shares;
    LimbSum& stored = shares.sum[mechanics::contact_friction_stored_half];
    for (const contact::ContactSums* sums : {&step.nodes, &step.edges}) {
      subtract(sums->terms.sum[contact::friction_work], _taken_by_friction);
      subtract(sums->terms.sum[contact::damping_work], _taken_by_damping);
      stored += sums->terms.sum[contact::friction_stored];
    }
    _edge_work += step.edges.terms.sum[contact::spring_work];
    for (LimbSum* sum : {&_taken_by_friction, &_taken_by_damping, &_edge_work})
      sum->carry();
    shares.sum[mechanics::contact_stored_half] = step.nodes.terms.sum[contact::spring_stored];
    shares.sum[mechanics::contact_edge_stored_half] = step.edges.terms.sum[contact::spring_stored];
    shares.sum[mechanics::contact_edge_work] = _edge_work;
    shares.sum[mechanics::contact_damping_dissipated] = _taken_by_damping;
    LimbSum& dissipated = shares.sum[mechanics::contact_friction_dissipated];
    dissipated = _taken_by_friction;
    subtract(stored, dissipated);
    return shares;
  }

  // Totals since the start on this rank, for restart files.
  std::array<LimbSum, 3> totals() const {
    return {_taken_by_friction, _taken_by_damping, _edge_work};
  }
  void restore(const std::array<LimbSum, 3>& totals) {
    _taken_by_friction = totals[0];
    _taken_by_damping = totals[1];
    _edge_work = totals[2];
  }

private:
  static void subtract(const LimbSum& term, LimbSum& from) {
    from.high -= term.high;
    from.low -= term.low;
    from.tail -= term.tail;
  }
  LimbSum _taken_by_friction, _taken_by_damping, _edge_work; // since the start
};

} // namespace brickwall::miniapp
