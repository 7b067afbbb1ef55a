// Exchanges between ranks to find the skin of cut bodies. Host code for set-up.
#pragma once

#include "contact/base/mpi.hpp"
#include "mechanics/mesh/hex_mesh.hpp"

#include <array>
#include <vector>

namespace brickwall::mechanics {

// The four global node ids of a face, ascending.
using FaceKey = std::array<global_id, 4>;

// For each face, how often the ranks together list it. Equal keys meet on rank (lowest id modulo
// ranks). Collective.
std::vector<std::int64_t> countFacesOnAllRanks(MPI_Comm comm, const std::vector<FaceKey>& keys);

// flag[node] becomes nonzero if it is so on any rank that shares the node. Collective.
void spreadToSharers(MPI_Comm comm, const SharedNodeLists& shared, std::vector<char>& flag);

} // namespace brickwall::mechanics
