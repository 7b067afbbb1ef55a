// Bodies whose elements are all the same parallelepiped of one material: their elements need no stored geometry
// Decided per body from input data, the same on every rank.
#pragma once

#include "contact/base/vec3.hpp"
#include "mechanics/mesh/hex_mesh.hpp"

namespace brickwall::mechanics {

struct BodyShape {
  bool congruent = false;
  bool whole = false; // all elements of the body are on this rank
  Mat3
      jacobian; // dX/dxi of every element, half-edges as columns; of the body's element of lowest global id
};

// One entry per mesh.bodies. Elements count as congruent when every edge vector agrees with those of the body's
// element of lowest global id to 1e-12 of (that element's longest edge + 8 ulp of its coordinates). Collective.
std::vector<BodyShape> markCongruentBodies(const exec_space& space, MPI_Comm comm,
                                           const HexMesh& mesh);

} // namespace brickwall::mechanics
