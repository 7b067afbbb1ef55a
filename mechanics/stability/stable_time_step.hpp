// Stable time step of central differences; theory.md, equations (30) to (34) and (40). The element
// bound is dt = 2/omega with omega^2 = (8/rho) lambda_max of the elasticity tensor on the mean
// gradient. It is exact on parallelepipeds; other elements take a factor 0.98. It holds for both
// kinds of element, because the hourglass modes of full integration are softer than these.
// If the largest omega^2 of the assembled bodies at rest is known (largest_frequency.hpp), longer
// steps are found. With each element rotated back by its rotation R and A(U) its moduli in that
// frame, K(u) is K(0) plus the contribution of A(U) - A(0). By Weyl's inequality omega^2(u) <=
// omega^2(0) + the element bound of A(U) - A(0) (and of the hourglass stiffness, which grows as the
// square of the largest stretch). Rotations differ between elements: if the nodes rotate relative
// to their element by theta at most, which the hourglass strains bound, omega(u) grows by theta
// omega_element at most.
// Bulk viscosity at a lagged velocity adds C: central differences are stable if dt^2 K/4 + dt C/2
// <= M. With c the largest eigenvalue of M^-1 C and xi = c/(2 omega), dt = (2/omega) (sqrt(1 +
// xi^2) - xi). In one dimension xi = b1 + b2^2 (l/c_d) |tr D|. An element that breathes in all
// three directions has more, sqrt(3 (lambda + 2 mu)/K) times as much if it is a cube (K: bulk
// modulus), so xi is taken from the element's own C.
// Contact adds springs and dampers to surface nodes, for which dt^2 K_c/4 + dt C_c/2 <= a M_s is
// known, with M_s the mass of the surface nodes. Then dt^2 K/4 + dt C/2 <= M - a M_s is sufficient:
// the step of bodies whose surface nodes are lighter by the fraction a. Interior nodes keep their
// mass, so bodies of several elements lose less of their step than by Weyl's inequality, which
// treats every node as a surface node.
// The elements' own masses, rho V/8 at each corner, sum to the lumped mass M_0. If the nodes of a
// body have the share kappa of it at least (body_inertia.hpp), then kappa M_0 <= M, and omega^2, c
// and growth of its elements are divided by kappa.
#pragma once

#include "mechanics/element/bulk_viscosity.hpp"
#include "mechanics/mesh/hex_mesh.hpp"

#include <cmath>
#include <string>

namespace brickwall::mechanics {

struct StableTimeStep {
  double dt = HUGE_VAL; // time; HUGE_VAL without elements
  global_id elem = -1; // global id of the element that limits it (lowest of equals)
};

// Terms besides the elastic stiffness that limit the step.
struct StabilityTerms {
  BulkViscosity viscosity;
  double rate = 0; // largest l |tr D|/c_d of compression of any element
  double contact = 0; // a of contactMassFraction
  View<const double*> mass_shares = {}; // kappa [elem]; empty: 1
};

// Bounds of omega^2 at rest, 1/time^2; the default uses the element bound alone.
struct RestFrequency {
  // of the assembled bodies, with surface nodes lighter by the contact's fraction
  double bodies = HUGE_VAL;
  // of the worst element by itself, with all nodes lighter by that fraction
  double elements = HUGE_VAL;
};

// Limits of the step by the elements at rest, over all ranks.
struct ElementsAtRest {
  StableTimeStep step; // by the worst element
  double step_without_viscosity = HUGE_VAL; // time
  double viscous = 0; // c of the worst element, 1/time
};
// One pass over the elements: small-strain moduli, closed form. The result does not depend on the
// partition. Collective.
ElementsAtRest findElementsAtRest(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                                  const StabilityTerms& load);
// The longer of the steps by elements and, with `rest`, by bodies.
StableTimeStep stableTimeStep(const ElementsAtRest& elements, const StabilityTerms& load,
                              const RestFrequency& rest);
// Both steps in one call.
StableTimeStep stableTimeStep(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                              const StabilityTerms& load = {}, const RestFrequency& rest = {});

// At X + u: the material's tangent moduli and stress at each element's centre. The 9x9 eigenvalue
// problems take about 10 us per element. With `rest`, norms of the matrices are tried first and
// suffice if the step that they allow is at least `enough`. A failed element (J <= 0, NaN) gives dt
// = 0. Collective.
StableTimeStep stableTimeStep(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                              const View<const double* [3]>& displacement,
                              const StabilityTerms& load = {}, const RestFrequency& rest = {},
                              double enough = HUGE_VAL);

// The largest fraction a of a surface node's mass that contact takes: mult (s/4 + zeta sqrt(s))
// with penalty s (capped by the reduced mass; two passes: mult 2.05) and damping zeta; crossing
// edges raise mult to 2.55. Friction adds nothing, since its spring has at most the same stiffness
// and acts at right angles to the normal one. Throws InputError unless zeta >= 0 and 0 < s <
// largestPenalty().
double contactMassFraction(double penalty, double damping = 0, bool edges = false);
// The penalty at which that fraction is 0.99: penalties must be below.
double largestPenalty(double damping, bool edges);
std::string boundOfPenalty(double damping, bool edges); // "below ...", for messages
// The penalty that gives, with this damping, the mass fraction of `undamped` alone.
double penaltyForMassFraction(double undamped, double damping);

// A copy of `mass` with surface nodes lighter by the fraction a.
View<double*> massUnderContact(const exec_space& space, const View<const double*>& mass,
                               const View<const int*>& surface_to_node, double contact_load);

} // namespace brickwall::mechanics
