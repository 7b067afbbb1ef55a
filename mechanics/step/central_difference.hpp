// Central differences with velocities at half steps: drift and kick, the kick together with the
// sums of the energy ledger.
#pragma once

#include "mechanics/ledger/ledger_sums.hpp"
#include "mechanics/loads/boundary_conditions.hpp"
#include "mechanics/mesh/hex_mesh.hpp"
#include "mechanics/mesh/nodal_state.hpp"
#include "mechanics/mesh/node_runs.hpp"

namespace brickwall::mechanics {

// u^{n+1} = u^n + dt v^{n+1/2}. Prescribed components need no more: their velocity is prescribed.
void drift(const exec_space& space, double dt, const NodalState& state);

// The same of some nodes.
void drift(const exec_space& space, double dt, const NodalState& state, const NodeSelection& nodes);

// v^{n+1/2} = v^{n-1/2} + dt (q sum of columns + m g)/m, then prescribed components, with dt = (dt^- + dt^+)/2, or
// dt^+/2 for the start from v^0; a dt < 0 takes part of a kick back. Damping by mass adds the force
// -alpha m (v^{n-1/2} + v^{n+1/2})/2, solved for exactly, so that it takes dt alpha m |mean v|^2 of energy in any step: no step
// is too long for it. `drift` is from t^n to t^{n+1}, what the new velocity is for. `forces` are totals (after the shared-node sum). Returns this rank's ledger sums over owned nodes. Not collective; fences.
KickSums kick(const exec_space& space, const HexMesh& mesh, const BoundaryConditions& boundary,
              const TimeSpan& drift, double dt, const NodalForces& forces, const NodalState& state,
              const LedgerScales& scales, const SpeedTest& test = {});
// The same of some nodes. Where the others rest, these count as one node that is tested for its speed.
KickSums kick(const exec_space& space, const HexMesh& mesh, const BoundaryConditions& boundary,
              const TimeSpan& drift, double dt, const NodalForces& forces, const NodalState& state,
              const LedgerScales& scales, const SpeedTest& test, const NodeSelection& nodes);

} // namespace brickwall::mechanics
