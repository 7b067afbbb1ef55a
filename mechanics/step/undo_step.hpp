// Takes back a kick and the drift before it, up to rounding, for the file that is written when a step has failed.
#pragma once

#include "mechanics/loads/boundary_conditions.hpp"
#include "mechanics/mesh/hex_mesh.hpp"
#include "mechanics/mesh/nodal_state.hpp"

namespace brickwall::miniapp {

// v^{n+1/2} -> v^{n-1/2} with the forces and the step `dt_kick` of the kick, then u^n -> u^{n-1} with the drift over t^{n-1} to
// t^n, of length `dt_drift`. Prescribed components get back the velocity that they had in this drift.
void undoKickAndDrift(const exec_space& space, const mechanics::HexMesh& mesh,
                      const mechanics::BoundaryConditions& boundary,
                      const mechanics::TimeSpan& drift, double dt_kick, double dt_drift,
                      const mechanics::NodalForces& forces, const mechanics::NodalState& state);

} // namespace brickwall::miniapp
