// The body of each node, for set-up.
#pragma once

#include "mechanics/mesh/host_mesh.hpp"

namespace brickwall::mechanics {

// [row of HexMesh::bodies] the first row of the same body. The elements of a body with several
// blocks need not be consecutive.
std::vector<int> firstRows(const HexMesh& mesh);

// [node] the first row of its body; the number of rows for a node without elements on this rank.
std::vector<int> bodyOfNodes(const exec_space& space, const HexMesh& mesh,
                             const std::vector<int>& first_rows);

} // namespace brickwall::mechanics
