// Bodies that have not moved yet, u = v = 0 exactly. Their elements have no force and no energy,
// they do not drift, and a kick does not change them. They are omitted from all three until a force
// acts on one of their nodes, without a change of any bit. Each rank decides for its part of a
// body: a disturbance of the other parts acts on the shared nodes and is detected there.
#pragma once

#include "mechanics/loads/boundary_conditions.hpp"
#include "mechanics/mesh/nodal_state.hpp"
#include "mechanics/mesh/node_runs.hpp"

#include <cstdint>
#include <vector>

namespace brickwall::mechanics {

class RestingBodies {
public:
  RestingBodies() = default; // none
  // Finds the bodies at rest in `state` without a node driven by `motions`; none under gravity.
  // `may_be_pushed` [node] marks nodes on which forces other than those of this rank's elements of
  // the body may act. Not collective.
  RestingBodies(const exec_space& space, const HexMesh& mesh, const NodalState& state,
                const std::vector<PrescribedMotion>& motions, const Vec3& gravity,
                const std::vector<char>& may_be_pushed);

  bool any() const { return _num_elems > 0; }
  std::int64_t numElems() const { return _num_elems; } // at rest
  // [row of HexMesh::bodies] 1: at rest. Rows of one body rest and wake together.
  const View<const int*>& flags() const { return _constant_flags; }
  // All nodes except those of resting bodies.
  const NodeSelection& movingNodes() const { return _moving; }

  // Wakes the bodies on which `forces`, the totals of this step, act. Call before the kick. Not
  // collective; fences.
  void wake(const exec_space& space, const NodalForces& forces);

private:
  void selectMoving(const exec_space& space);

  View<int*> _flags;
  View<const int*> _constant_flags;
  Kokkos::View<int*, Kokkos::HostSpace> _host_flags;
  // Nodes of bodies that rested at the start where a force may act first, and the first row of
  // their body.
  View<int*> _watched, _body_of_watched;
  std::vector<int> _first_row; // [row] first row of the same body
  bool _has_several_rows = false; // of any body
  // [first row of a body]; the last entry holds the nodes without a body.
  std::vector<std::vector<NodeRun>> _runs;
  std::vector<int> _elems; // [row] number of elements
  View<NodeRun*> _moving_runs; // with room for all nodes
  Kokkos::View<NodeRun*, Kokkos::HostSpace> _host_runs;
  NodeSelection _moving;
  int _num_nodes = 0;
  std::int64_t _num_elems = 0;
};

} // namespace brickwall::mechanics
