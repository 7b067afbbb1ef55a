#include "mechanics/step/resting_bodies.hpp"

#include "contact/base/to_device.hpp"
#include "mechanics/mesh/host_mesh.hpp"

#include <algorithm>
#include <cstring>

namespace brickwall::mechanics {

namespace {

// A negative zero counts as motion, since a kick changes it to a positive zero.
KOKKOS_INLINE_FUNCTION bool moves(const View<double* [3]>& field, std::int64_t node) {
  for (int i = 0; i < 3; ++i) {
    std::int64_t bits = 0;
    memcpy(&bits, &field(node, i), sizeof bits);
    if (bits != 0)
      return true;
  }
  return false;
}

// [body] whether each of its nodes has zero displacement and velocity, by the body of each node.
std::vector<int> bodiesAtRest(const exec_space& space, const NodalState& state,
                              const std::vector<int>& body_of_nodes, int num_bodies) {
  const auto body_of = toDevice(space, "mechanics::RestingBodies::body_of_nodes", body_of_nodes);
  const auto rests = allocate<View<int*>>(space, "mechanics::RestingBodies::rests", num_bodies);
  const auto u = state.displacement, v = state.velocity;
  Kokkos::deep_copy(space, rests, 1);
  Kokkos::parallel_for(
      "mechanics::RestingBodies::rests", rangePolicy(space, body_of.extent(0)),
      KOKKOS_LAMBDA(const std::int64_t node) {
        if (moves(u, node) || moves(v, node))
          storeShared(rests(body_of(node)), 0);
      });
  space.fence();
  const auto host = toHost(rests);
  return std::vector<int>(host.data(), host.data() + num_bodies);
}

} // namespace

RestingBodies::RestingBodies(const exec_space& space, const HexMesh& mesh, const NodalState& state,
                             const std::vector<PrescribedMotion>& motions, const Vec3& gravity,
                             const std::vector<char>& may_be_pushed)
    : _first_row(firstRows(mesh)), _num_nodes(mesh.num_nodes) {
  const int num_bodies = static_cast<int>(mesh.bodies.size());
  const std::vector<int> body_of = bodyOfNodes(space, mesh, _first_row);
  std::vector<int> rests(num_bodies + 1, 0); // the last entry is that of nodes without a body
  if (dot(gravity, gravity) == 0)
    rests = bodiesAtRest(space, state, body_of, num_bodies + 1);
  rests[num_bodies] = 0;
  for (const PrescribedMotion& motion : motions)
    if (dot(motion.velocity, motion.velocity) != 0)
      for (const int node : motion.nodes)
        rests[body_of[node]] = 0;
  _moving = NodeSelection::allOf(_num_nodes);
  if (std::count(rests.begin(), rests.end(), 1) == 0)
    return;

  _runs.resize(num_bodies + 1);
  std::vector<int> watched, body_of_watched;
  std::size_t num_runs = 0;
  for (int node = 0; node < _num_nodes; ++node) {
    appendNode(node, _runs[body_of[node]]);
    if (rests[body_of[node]] && may_be_pushed[node]) {
      watched.push_back(node);
      body_of_watched.push_back(body_of[node]);
    }
  }
  for (const auto& runs : _runs)
    num_runs += runs.size();
  rests.pop_back();
  for (int b = 0; b < num_bodies; ++b) {
    _elems.push_back(mesh.bodies[b].count);
    rests[b] = rests[_first_row[b]];
    _has_several_rows = _has_several_rows || _first_row[b] != b;
  }
  _flags = toDevice(space, "mechanics::RestingBodies::flags", rests);
  _constant_flags = _flags;
  _host_flags = Kokkos::View<int*, Kokkos::HostSpace>("mechanics::RestingBodies::host_flags",
                                                      static_cast<std::size_t>(num_bodies));
  _watched = toDevice(space, "mechanics::RestingBodies::watched", watched);
  _body_of_watched = toDevice(space, "mechanics::RestingBodies::body_of_watched", body_of_watched);
  _moving_runs = View<NodeRun*>("mechanics::RestingBodies::moving_runs", num_runs);
  _host_runs =
      Kokkos::View<NodeRun*, Kokkos::HostSpace>("mechanics::RestingBodies::host_runs", num_runs);
  selectMoving(space);
}

// Selects whole runs of the moving bodies, or all nodes if no body rests.
void RestingBodies::selectMoving(const exec_space& space) {
  space.fence();
  Kokkos::deep_copy(_host_flags, _flags);
  for (std::size_t b = 0; b < _elems.size(); ++b)
    _host_flags(b) = _host_flags(_first_row[b]);
  if (_has_several_rows)
    Kokkos::deep_copy(_flags, _host_flags);
  _num_elems = 0;
  std::size_t count = 0;
  for (std::size_t b = 0; b < _runs.size(); ++b) {
    if (b < _elems.size() && _host_flags(b) != 0) {
      _num_elems += _elems[b];
      continue;
    }
    for (const NodeRun& run : _runs[b])
      _host_runs(count++) = run;
  }
  _moving = NodeSelection::allOf(_num_nodes);
  if (_num_elems == 0)
    return;
  const auto some = std::make_pair(std::size_t(0), count);
  const auto moving = Kokkos::subview(_moving_runs, some);
  Kokkos::deep_copy(moving, Kokkos::subview(_host_runs, some));
  _moving.all = false;
  _moving.others_rest = true;
  _moving.runs = moving;
}

void RestingBodies::wake(const exec_space& space, const NodalForces& forces) {
  if (!any())
    return;
  const auto flags = _flags;
  const auto watched = _watched, body_of_watched = _body_of_watched;
  const auto values = forces.values;
  const int columns = static_cast<int>(values.extent(1));
  int woken = 0;
  Kokkos::parallel_reduce(
      "mechanics::RestingBodies::wake", rangePolicy(space, watched.extent(0)),
      KOKKOS_LAMBDA(const std::int64_t i, int& count) {
        int* const flag = &flags(body_of_watched(i));
        if (loadShared(*flag) == 0)
          return;
        std::int64_t some = 0;
        for (int column = 0; column < columns; ++column)
          some |= values(watched(i), column);
        if (some != 0)
          count += Kokkos::atomic_exchange(flag, 0);
      },
      woken);
  if (woken > 0)
    selectMoving(space);
}

} // namespace brickwall::mechanics
