// Central differences with velocities at half steps (leapfrog): drift and kick, the kick together
// with the sums of the energy ledger; theory.md, equations (17) to (19).
#pragma once

#include "mechanics/ledger/ledger_sums.hpp"
#include "mechanics/loads/boundary_conditions.hpp"
#include "mechanics/mesh/hex_mesh.hpp"
#include "mechanics/mesh/nodal_state.hpp"
#include "mechanics/mesh/node_runs.hpp"

namespace brickwall::mechanics {

// u^{n+1} = u^n + dt v^{n+1/2}, equation (17). Prescribed components need no special treatment,
// since their velocity is prescribed.
void drift(const exec_space& space, double dt, const NodalState& state);

// The same for a selection of nodes.
void drift(const exec_space& space, double dt, const NodalState& state, const NodeSelection& nodes);

// Whether a kick can compute the next drift as well.
constexpr bool can_drift_ahead = !fills_lanes;

// v^{n+1/2} = v^{n-1/2} + dt (q sum of columns + m g)/m, equation (18), then prescribed components.
// dt = (dt^- + dt^+)/2, or dt^+/2 for the start from v^0; a dt < 0 takes part of a kick back.
// Mass-proportional damping adds the force -alpha m (v^{n-1/2} + v^{n+1/2})/2, equation (19),
// solved exactly, so that it dissipates dt alpha m |mean v|^2 and does not limit the time step.
// `drift` spans t^n to t^{n+1}, where the new velocity applies. `forces` are totals (after the
// shared-node sum). Returns this rank's ledger sums over owned nodes. Not collective; fences.
KickSums kick(const exec_space& space, const HexMesh& mesh, const BoundaryConditions& boundary,
              const TimeSpan& drift, double dt, const NodalForces& forces, const NodalState& state,
              const LedgerScales& scales, const SpeedTest& test = {});
// The same for a selection of nodes. If the others rest, they count as one node in the test of
// speeds. With can_drift_ahead, `ahead` receives the displacement after the next drift.
KickSums kick(const exec_space& space, const HexMesh& mesh, const BoundaryConditions& boundary,
              const TimeSpan& drift, double dt, const NodalForces& forces, const NodalState& state,
              const LedgerScales& scales, const SpeedTest& test, const NodeSelection& nodes,
              const DriftAhead& ahead = {});

} // namespace brickwall::mechanics
