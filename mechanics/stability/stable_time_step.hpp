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
//
// Contact adds springs and dampers to nodes of the surface, of which dt^2 K_c/4 + dt C_c/2 <= a M_s is known, M_s the mass of the
// surface's nodes. Then dt^2 K/4 + dt C/2 <= M - a M_s is enough: the step of bodies whose surface is lighter by a. An inner
// node has all its mass, so bodies of several elements lose less of their step than by Weyl, for whom every node is on the surface.
#pragma once

#include "mechanics/element/bulk_viscosity.hpp"
#include "mechanics/mesh/hex_mesh.hpp"

namespace brickwall::mechanics {

struct StableTimeStep {
  double dt = HUGE_VAL; // time; HUGE_VAL without elements
  global_id elem = -1; // global id of the element that limits it (lowest of equals)
};

// What else the step must allow for.
struct StabilityTerms {
  BulkViscosity viscosity;
  double rate = 0; // largest l |tr D|/c_d of compression of any element
  double contact = 0; // a, of contactMassFraction
};

// Bounds of omega^2 at rest, 1/time^2; without knowledge of the bodies the element bound does alone.
struct RestFrequency {
  double bodies = HUGE_VAL; // of the assembled bodies, their surface lighter by the load's share
  double elements = HUGE_VAL; // of the worst element by itself, with all nodes lighter by that
};

// What the elements say of the step at rest, over all ranks.
struct ElementsAtRest {
  StableTimeStep step; // by the worst element
  double step_without_viscosity = HUGE_VAL; // time
  double viscous = 0; // c of the worst element, 1/time
};
// One pass over the elements: small-strain moduli, closed form. The same for any partition. Collective.
ElementsAtRest findElementsAtRest(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                                  const StabilityTerms& load);
// The longer of the steps by elements and, with `rest`, by bodies.
StableTimeStep stableTimeStep(const ElementsAtRest& elements, const StabilityTerms& load,
                              const RestFrequency& rest);
// Both at once.
StableTimeStep stableTimeStep(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                              const StabilityTerms& load = {}, const RestFrequency& rest = {});

// At X + u: the material's tangent moduli and stress at each element's centre (9x9 eigenvalue problems, about 10 us an
// element: call it rarely). With `rest` plain norms of the matrices are tried first, and they do where the
// step that they allow is `enough`. A failed element (J <= 0, NaN) gives dt = 0. Collective.
StableTimeStep stableTimeStep(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                              const View<const double* [3]>& displacement,
                              const StabilityTerms& load = {}, const RestFrequency& rest = {},
                              double enough = HUGE_VAL);

// The largest share a of a surface node's mass that contact takes: mult (s/4 + zeta sqrt(s)) with penalty s (capped by the reduced
// mass, two passes: mult 2.05), damping zeta; crossing edges bring mult to 2.55. Friction needs nothing more: its spring, of at most
// the same stiffness, acts across the normal one. Throws InputError unless s >= 0, zeta >= 0 and a <= .99.
double contactMassFraction(double penalty, double damping = 0, bool edges = false);
// The penalty that brings, with this damping, the load of `undamped` alone.
double penaltyForMassFraction(double undamped, double damping);

// `mass` where nodes of the surface are lighter by a.
View<double*> massUnderContact(const exec_space& space, const View<const double*>& mass,
                               const View<const int*>& surface_to_node, double contact_load);

} // namespace brickwall::mechanics
