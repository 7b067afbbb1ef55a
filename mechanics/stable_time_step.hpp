// Stable step of central differences from the element bound: dt = 2/omega, omega^2 =
// (8/rho) lambda_max of the elasticity tensor on the mean gradient; exact on parallelepipeds, times .98 on others.
// It holds for both kinds of element: full integration adds hourglass modes that are softer than these.
//
// Where the largest omega^2 of the assembled bodies at rest is known (largest_frequency.hpp), longer steps are found. With every
// element turned back by its rotation R and A(U) its moduli there, K(u) = K(0) + what A(U) - A(0) makes, so by Weyl
// omega^2(u) <= omega^2(0) + the element bound of A(U) - A(0) (and of hourglass stiffness, which grows as the longest
// stretch squared). Elements do not all turn alike: where their nodes turn against them by theta at most, as the hourglass
// strains tell, omega(u) is larger by theta omega_element at most.
//
// Bulk viscosity at a lagged velocity adds C: central differences are stable if dt^2 K/4 + dt C/2 <= M. With c the largest
// eigenvalue of M^-1 C and xi = c/(2 omega), dt = (2/omega) (sqrt(1 + xi^2) - xi). In one dimension xi = b1 + b2^2 (l/c_d)
// |tr D|; an element that breathes in all three directions has more, sqrt(3 (lambda + 2 mu)/K) times as much if it is a
// cube (K: bulk modulus), so xi is taken from the element's own C.
#pragma once

#include "mechanics/bulk_viscosity.hpp"
#include "mechanics/hex_mesh.hpp"

namespace brickwall::mechanics {

struct StableTimeStep {
  double dt = HUGE_VAL; // time; HUGE_VAL without elements
  global_id elem = -1; // global id of the element that limits it (lowest of equals)
};

// What else the step must allow for.
struct StepViscosity {
  BulkViscosity viscosity;
  double rate = 0; // largest l |tr D|/c_d of compression of any element
  // chi: the step will be chi times the result, and dt^2 omega^2/4 + dt c/2 <= chi^2, so that contact may use the rest
  // whether there is viscosity or not.
  double share = 1;
};

// Bounds of omega^2 at rest, 1/time^2; without knowledge of the bodies the element bound does alone.
struct RestFrequency {
  double bodies = HUGE_VAL; // of the assembled bodies
  double elements = HUGE_VAL; // of the worst element by itself
};

// At rest (u = 0): small-strain moduli, closed form; the longer of the steps by elements and, with `rest`, by bodies. Same on all ranks and for any partition. Collective.
StableTimeStep stableTimeStep(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                              const StepViscosity& viscous = {}, const RestFrequency& rest = {});

// At X + u: the material's tangent moduli and stress at each element's centre (9x9 eigenvalue problems, about 10 us an
// element: call it rarely). With `rest` plain norms of the matrices are tried first, and they do where the
// step that they allow is `enough`. A failed element (J <= 0, NaN) gives dt = 0. Collective.
StableTimeStep stableTimeStep(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                              const View<const double* [3]>& displacement,
                              const StepViscosity& viscous = {}, const RestFrequency& rest = {},
                              double enough = HUGE_VAL);

// Largest share chi = dt/dt_stable of the step next to contact of penalty s (capped by the reduced mass, two passes) and
// damping zeta, with crossing edges or without: min(safety, sqrt(1 - mult (s/4 + zeta sqrt(s)))), mult 2.05, with edges 2.55.
// Friction needs nothing more: its spring, of at most the same stiffness, acts across the normal one. Throws InputError unless
// 0 < safety <= 1, 0 <= s < 1.95, zeta >= 0, and the share is .1 at least.
double contactStepShare(double safety, double penalty, double damping = 0, bool edges = false);

} // namespace brickwall::mechanics
