// The power of the nodal forces of one kind.
#pragma once

#include "mechanics/ledger/ledger_sums.hpp"
#include "mechanics/mesh/hex_mesh.hpp"
#include "mechanics/mesh/nodal_state.hpp"

namespace brickwall::mechanics {

// Sum of f . v over all nodes of all ranks; `forces` are totals (after the shared-node sum). The same bits on any layout. Collective.
double forcePower(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                  const NodalForces& forces, const NodalState& state, ForceKind kind,
                  const LedgerScales& scales);

} // namespace brickwall::mechanics
