// Stable step of central differences from the element bound of physics.md section 2: dt = 2/omega, omega^2 =
// (8/rho) lambda_max of the elasticity tensor on the mean gradient; exact on parallelepipeds, times .98 on others.
// It holds for both kinds of element: full integration adds hourglass modes that are softer than these.
#pragma once

#include "mechanics/hex_mesh.hpp"

namespace brickwall::mechanics {

struct StableTimeStep {
  double dt = HUGE_VAL; // time; HUGE_VAL without elements
  global_id elem = -1; // global id of the element that limits it (lowest of equals)
};

// At rest (u = 0): small-strain moduli, closed form. Same on all ranks and for any partition. Collective.
StableTimeStep stableTimeStep(const exec_space& space, MPI_Comm comm, const HexMesh& mesh);

// At X + u: the material's tangent moduli and stress at each element's centre (9x9 eigenvalue problem, about 10 us an
// element: call it rarely). A failed element (J <= 0, NaN) gives dt = 0. Collective.
StableTimeStep stableTimeStep(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                              const View<const double* [3]>& displacement);

// Largest share chi = dt/dt_stable of the step next to contact of penalty s (capped by the reduced mass, two passes) and
// damping zeta, with crossing edges or without: min(safety, sqrt(1 - mult (s/4 + zeta sqrt(s)))), mult 2.05, with edges 2.55.
// Friction needs nothing more: its spring, of at most the same stiffness, acts across the normal one. Throws InputError unless
// 0 < safety <= 1, 0 <= s < 1.95, zeta >= 0, and the share is .1 at least.
double contactStepShare(double safety, double penalty, double damping = 0, bool edges = false);

} // namespace brickwall::mechanics
