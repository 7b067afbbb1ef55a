// Largest frequency of free vibration of whole bodies at rest by the Lanczos method (Paige 1972;
// Parlett, The Symmetric Eigenvalue Problem, ch. 13); theory.md, equation (35). The element bound
// is that of the worst element by itself; in an assembly its neighbours restrain that mode, so
// bodies of several elements allow longer steps.
// One Krylov space serves all bodies at once (K is block-diagonal), with one body per type. The
// largest Ritz value theta of omega^2 is never above the true one, so a margin is added. For a
// random start vector the probability that theta is below (1 - eps) omega^2 after k products is at
// most 1.648 sqrt(n) exp(-(2 k - 1) sqrt(eps)) with n unknowns, for any spectrum (Kuczynski and
// Wozniakowski, SIAM J. Matrix Anal. Appl. 13 (1992)); eps is chosen for a probability of 1/1000.
// After 120 products with some thousand unknowns the margin is 0.1 % of the step. Nothing is added
// if theta has converged to rounding. (A small residual is not sufficient: it shows that an
// eigenvalue is near theta, not that it is the largest.)
// The bits do not depend on the partition: forces and dot products are summed as integers, and the
// start vector depends on node ids only.
#pragma once

#include "mechanics/force/internal_force.hpp"
#include "mechanics/mesh/body_types.hpp"
#include "mechanics/mesh/hex_mesh.hpp"
#include "mechanics/stability/stable_time_step.hpp"

namespace brickwall::mechanics {

struct LargestFrequency {
  RestFrequency bound; // theta/(1 - eps) and the element bound; the default if nothing was found
  double ritz = 0; // theta, a lower bound
  int products = 0; // with K
};

// `mass` as from lumpedMass, `types` as from findBodyTypes, `element_step` as from stableTimeStep
// without viscosity; the element bound caps the result. Takes 60 to 120 products of about 0.3 us per
// element of one body per type, and 500 B per element during the call. Collective.
LargestFrequency largestFrequency(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                                  const SharedNodeLists& shared, const View<const double*>& mass,
                                  const BodyTypes& types, ElementKind kind, double element_step);

} // namespace brickwall::mechanics
