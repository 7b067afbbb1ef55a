// Bodies whose elements are all the same parallelepiped of one material, so that no geometry is
// stored per element. This is decided per body from input data, and is the same on every rank.
#pragma once

#include "contact/base/vec3.hpp"
#include "mechanics/mesh/hex_mesh.hpp"

namespace brickwall::mechanics {

struct BodyShape {
  bool congruent = false;
  bool whole = false; // all elements of the body are on this rank
  // dX/dxi of the body's element of lowest global id, half-edges as columns; that of every element
  // if congruent
  Mat3 jacobian;
};

// One entry per mesh.bodies. Elements are congruent if every edge vector agrees with that of the
// body's element of lowest global id to 1e-12 of (that element's longest edge + 8 ulp of its
// coordinates). Collective.
std::vector<BodyShape> markCongruentBodies(const exec_space& space, MPI_Comm comm,
                                           const HexMesh& mesh);

} // namespace brickwall::mechanics
