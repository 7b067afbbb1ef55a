// Free bricks: lattices of elements, whole on this rank, without loads and contact. Their drift,
// forces and kick are one sweep that stores no forces, so that each nodal value is read and written
// once per step. Every bit is that of drift(), InternalForce::add() and kick().
#pragma once

#include "mechanics/force/internal_force.hpp"
#include "mechanics/ledger/ledger_sums.hpp"
#include "mechanics/loads/boundary_conditions.hpp"
#include "mechanics/mesh/node_runs.hpp"

#include <cstdint>
#include <vector>

namespace brickwall::mechanics {

class FreeBricks {
public:
  FreeBricks() = default; // none
  // Removes these bricks from InternalForce::add(). `is_loaded` [node] marks nodes on which forces
  // may act other than internal forces, gravity, prescribed motions and mass-proportional damping.
  // Not collective.
  FreeBricks(const exec_space& space, const HexMesh& mesh, InternalForce& internal,
             const std::vector<char>& is_loaded);

  bool any() const { return _slabs.extent(0) > 0; }
  std::int64_t numElems() const { return _num_elems; }
  const NodeSelection& otherNodes() const { return _other_nodes; }

  struct Result {
    InternalForceResult internal;
    KickSums kick;
  };
  // u += dt_drift v if `drifts`, then v as in kick(), with the same arguments. Not collective;
  // fences.
  Result step(const exec_space& space, const HexMesh& mesh, const InternalForce& internal,
              const BoundaryConditions& boundary, const TimeSpan& next_drift, bool drifts,
              double dt_drift, double dt_kick, const NodalState& state, const LedgerScales& scales,
              const SpeedTest& test = {}) const;

private:
  View<LatticeSlab*> _slabs;
  NodeSelection _own_nodes, _other_nodes;
  // some lattice is cut into slabs, so that the drift is a separate kernel
  bool _has_pieces = false;
  std::int64_t _num_elems = 0;
};

} // namespace brickwall::mechanics
