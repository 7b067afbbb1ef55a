// Largest frequency of free vibration of whole bodies at rest, by the Lanczos method (Paige 1972; Parlett, The Symmetric
// Eigenvalue Problem, ch. 13). The element bound is that of the worst element by itself; next to others it can not
// swing like that, so bodies of several elements allow longer steps.
//
// One Krylov space for all bodies at once (K is block-diagonal), of one body a type. Lanczos' largest value theta of
// omega^2 is never above the true one, so some must be added. For a start vector at random the chance that theta is below
// (1 - eps) omega^2 after k products is at most 1.648 sqrt(n) exp(-(2 k - 1) sqrt(eps)), n: unknowns, whatever the
// spectrum (Kuczynski and Wozniakowski, SIAM J. Matrix Anal. Appl. 13 (1992)): eps is taken for a chance of 1/1000. After
// 120 products with some thousand unknowns that is .1 % of the step. Nothing is added where
// theta has converged to rounding. (A small residual would not do: it tells that an eigenvalue is near theta, not that it
// is the largest.)
//
// Same bits for any partition: forces and dot products are added as integers, the start vector is made of node ids.
#pragma once

#include "mechanics/force/internal_force.hpp"
#include "mechanics/mesh/hex_mesh.hpp"
#include "mechanics/stability/stable_time_step.hpp"

namespace brickwall::mechanics {

struct LargestFrequency {
  RestFrequency bound; // theta/(1 - eps), the element bound; as by default where nothing was found
  double ritz = 0; // theta, the value from below
  int products = 0; // with K
  std::int64_t body_types = 0;
};

// `mass` as of lumpedMass, `element_step` as of stableTimeStep without viscosity: the element bound caps the result. Takes
// At most 60 to 120 products of about .3 us an element of one body a type, and 500 B an element while it runs. Collective.
LargestFrequency largestFrequency(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                                  const SharedNodeLists& shared, const View<const double*>& mass,
                                  ElementKind kind, double element_step);

} // namespace brickwall::mechanics
