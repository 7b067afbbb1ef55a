// Bricks that step by themselves: lattices of elements, whole on this rank, on which no load acts. In a scene
// without contact their drift, forces and kick are one sweep that keeps no forces: each node's numbers are read and written
// once. Every bit is that of drift(), InternalForce::add() and kick().
#pragma once

#include "mechanics/force/internal_force.hpp"
#include "mechanics/ledger/ledger_sums.hpp"
#include "mechanics/loads/boundary_conditions.hpp"
#include "mechanics/mesh/node_runs.hpp"

namespace brickwall::mechanics {

class FreeBricks {
public:
  FreeBricks() = default; // none
  // Takes these bricks out of InternalForce::add(). `is_loaded` [node]: forces other than the internal ones, gravity,
  // prescribed motions and damping by mass may act. Not collective.
  FreeBricks(const exec_space& space, const HexMesh& mesh, InternalForce& internal,
             const std::vector<char>& is_loaded);

  bool any() const { return _slabs.extent(0) > 0; }
  std::int64_t numElems() const { return _num_elems; }
  const NodeSelection& otherNodes() const { return _other_nodes; }

  struct Result {
    InternalForceResult internal;
    KickSums kick;
  };
  // u += dt_drift v if `drifts`, then v as kick() does. Arguments as there. Not collective; fences.
  Result step(const exec_space& space, const HexMesh& mesh, const InternalForce& internal,
              const BoundaryConditions& boundary, const TimeSpan& next_drift, bool drifts,
              double dt_drift, double dt_kick, const NodalState& state, const LedgerScales& scales,
              const SpeedTest& test = {}) const;

private:
  View<LatticeSlab*> _slabs;
  NodeSelection _own_nodes, _other_nodes;
  bool _has_pieces = false; // of lattices, so that drifts are apart
  std::int64_t _num_elems = 0;
};

} // namespace brickwall::mechanics
