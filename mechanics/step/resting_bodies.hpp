// Bodies that nothing has moved yet, u = v = 0 exactly: their elements have no force and no energy, they do not drift, and a kick
// leaves them as they are. So they are left out of all three until a force acts on one of their nodes, and no bit changes.
// Each rank decides for its part of a body: what moves the other parts acts on the nodes that both share, and is seen there.
#pragma once

#include "mechanics/loads/boundary_conditions.hpp"
#include "mechanics/mesh/nodal_state.hpp"
#include "mechanics/mesh/node_runs.hpp"

namespace brickwall::mechanics {

class RestingBodies {
public:
  RestingBodies() = default; // none
  // Those at rest in `state`, none of whose nodes is driven by `motions`; none at all under gravity. `may_be_pushed` [node]: other
  // forces than those of its body's elements on this rank may act. Not collective.
  RestingBodies(const exec_space& space, const HexMesh& mesh, const NodalState& state,
                const std::vector<PrescribedMotion>& motions, const Vec3& gravity,
                const std::vector<char>& may_be_pushed);

  bool any() const { return _num_elems > 0; }
  std::int64_t numElems() const { return _num_elems; } // of those that rest
  // [row of HexMesh::bodies] 1: rests; rows of one body rest and wake together.
  const View<const int*>& flags() const { return _constant_flags; }
  // All nodes but those of bodies that rest.
  const NodeSelection& movingNodes() const { return _moving; }

  // Bodies on which `forces` act, all of this step, rest no more. Before the kick. Not collective; fences.
  void wake(const exec_space& space, const NodalForces& forces);

private:
  void selectMoving(const exec_space& space);

  View<int*> _flags;
  View<const int*> _constant_flags;
  Kokkos::View<int*, Kokkos::HostSpace> _host_flags;
  // Nodes of bodies that rested at the start, where a force may act first, and the first row of their body.
  View<int*> _watched, _body_of_watched;
  std::vector<int> _first_row; // [row] of the same body
  bool _has_several_rows = false; // some body
  // [first row of a body], and those of nodes without a body.
  std::vector<std::vector<NodeRun>> _runs;
  std::vector<int> _elems; // [row]
  View<NodeRun*> _moving_runs; // as many as fit all nodes
  Kokkos::View<NodeRun*, Kokkos::HostSpace> _host_runs;
  NodeSelection _moving;
  int _num_nodes = 0;
  std::int64_t _num_elems = 0;
};

} // namespace brickwall::mechanics
