// Bodies that are translated copies of each other: the same elements of the same elastic constants
// and density. Quantities that depend on these alone are computed once per type, for the body of
// lowest number.
#pragma once

#include "mechanics/mesh/hex_mesh.hpp"

#include <vector>

namespace brickwall::mechanics {

struct BodyTypes {
  // One entry per mesh.bodies: the lowest number of a body of the same type, and the body's lowest
  // global node id.
  std::vector<global_id> representative, first_node;
  std::int64_t count = 0; // types on all ranks
};

// Bodies are of one type if their elements and nodes follow each other alike in global id, edges
// agree to 2^-24 of the longest edge of the body, and densities and elastic constants are equal.
// They are compared by 63-bit hashes. The result does not depend on the partition. Collective.
BodyTypes findBodyTypes(const exec_space& space, MPI_Comm comm, const HexMesh& mesh);

} // namespace brickwall::mechanics
