// Nodal masses with the mass, the centre and the inertia tensor of each body: the least relative
// change of the lumped masses under ten moment conditions; theory.md, equations (36) to (40).
// Sums over a body are integers, so the bits do not depend on the number of ranks or threads.
#pragma once

#include "mechanics/mesh/hex_mesh.hpp"

namespace brickwall::mechanics {

// No nodal mass falls below this fraction of the lumped one.
constexpr double least_mass_share = 0.25;

struct BodyMass {
  View<double*> mass; // [node], owned or not
  View<double*> least_shares; // [elem], least mass/lumped of the nodes of the element's body
};

// From the masses of lumpedMass. Second moments that positive masses cannot have (one element
// through the thickness) stay as they are. About 1 us per node, in set-up. Collective.
BodyMass massWithInertia(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                         const View<const double*>& lumped);

} // namespace brickwall::mechanics
