// See edge_contact.hpp.
#include "contact/edge_contact.hpp"

#include "contact/base/region.hpp"
#include "contact/edge_separation.hpp"

#include <algorithm>

namespace brickwall::contact {
namespace {

template <class ViewType>
auto hostCopy(const ViewType& view) {
  return Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), view);
}

// A device View filled on the host by set(host view).
template <class ViewType, class Set, class... Extents>
ViewType filled(const exec_space& space, const std::string& label, const Set& set,
                Extents... extents) {
  auto device = allocate<ViewType>(space, label, extents...);
  auto host = Kokkos::create_mirror_view(device);
  set(host);
  Kokkos::deep_copy(space, device, host);
  space.fence();
  return device;
}

// Numbers that no node of a mesh has.
constexpr global_id first_edge_node_id = global_id(1) << 60;

// Nodes of the host's surface at the corners of the listed faces, ascending.
std::vector<int> cornersOf(const Surface& surface, const FeatureEdges& edges) {
  const auto face_to_nodes = hostCopy(surface.face_to_nodes);
  std::vector<int> corners;
  for (const FeatureEdge& edge : edges.convex)
    for (int j = 0; j < 4; ++j)
      corners.push_back(face_to_nodes(edge.face, j));
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

// The static part of the surface of edges.
Surface edgeSurface(const exec_space& space, const Surface& surface, const FeatureEdges& edges,
                    const std::vector<int>& corners) {
  const int num_corners = static_cast<int>(corners.size());
  const int num_edges = static_cast<int>(edges.convex.size());
  const int num_nodes = num_corners + num_edges;
  const auto face_to_nodes = hostCopy(surface.face_to_nodes);
  const auto node_ids = hostCopy(surface.node_ids), face_ids = hostCopy(surface.face_ids);
  const auto node_body = hostCopy(surface.node_body), face_body = hostCopy(surface.face_body);
  const auto attributes = hostCopy(surface.face_attributes);
  const auto idOf = [&](int e) {
    return 4 * face_ids(edges.convex[e].face) + edges.convex[e].edge;
  };
  Surface s;
  s.num_nodes = num_nodes;
  s.num_faces = num_edges;
  s.face_to_nodes = filled<View<int* [4]>>(
      space, "contact::EdgeContact::edge_to_nodes",
      [&](auto& v) {
        for (int e = 0; e < num_edges; ++e)
          for (int j = 0; j < 4; ++j) {
            const int node = face_to_nodes(edges.convex[e].face, (edges.convex[e].edge + j) % 4);
            v(e, j) = static_cast<int>(std::lower_bound(corners.begin(), corners.end(), node) -
                                       corners.begin());
          }
      },
      num_edges);
  s.node_ids = filled<View<global_id*>>(
      space, "contact::EdgeContact::node_ids",
      [&](auto& v) {
        for (int i = 0; i < num_nodes; ++i)
          v(i) =
              i < num_corners ? node_ids(corners[i]) : first_edge_node_id + idOf(i - num_corners);
      },
      num_nodes);
  s.node_body = filled<View<global_id*>>(
      space, "contact::EdgeContact::node_body",
      [&](auto& v) {
        for (int i = 0; i < num_nodes; ++i)
          v(i) = i < num_corners ? node_body(corners[i])
                                 : face_body(edges.convex[i - num_corners].face);
      },
      num_nodes);
  s.node_is_owned = filled<View<unsigned char*>>( // only edges look for partners
      space, "contact::EdgeContact::node_is_owned",
      [&](auto& v) {
        for (int i = 0; i < num_nodes; ++i)
          v(i) = i >= num_corners;
      },
      num_nodes);
  s.face_ids = filled<View<global_id*>>(
      space, "contact::EdgeContact::edge_ids",
      [&](auto& v) {
        for (int e = 0; e < num_edges; ++e)
          v(e) = idOf(e);
      },
      num_edges);
  s.face_body = filled<View<global_id*>>(
      space, "contact::EdgeContact::edge_body",
      [&](auto& v) {
        for (int e = 0; e < num_edges; ++e)
          v(e) = face_body(edges.convex[e].face);
      },
      num_edges);
  s.face_attributes = filled<View<double**>>(
      space, "contact::EdgeContact::attributes",
      [&](auto& v) {
        for (int e = 0; e < num_edges; ++e) {
          const FeatureEdge& edge = edges.convex[e];
          for (int j = 0; j < 4; ++j)
            v(e, j) = attributes(edge.face, (edge.edge + j) % 4);
          v(e, EdgeTouch::cosine_column) = edge.cosine;
          v(e, EdgeTouch::sine_column) = edge.sine;
          v(e, EdgeTouch::goes_on_column) = edge.goes_on;
        }
      },
      num_edges, EdgeTouch::num_columns);
  return s;
}

} // namespace

EdgeContact::EdgeContact(const exec_space& space, MPI_Comm comm, const Surface& surface,
                         const FeatureEdges& edges, const View<const double*>& node_mass,
                         const SearchConfig& search, double margin, const EnforcementConfig& config,
                         const Quantum& quantum, const LimbScale& energy_scale)
    : _search(comm, search, margin), _config(config), _energy_scale(energy_scale) {
  const std::vector<int> corners = cornersOf(surface, edges);
  _num_corners = static_cast<int>(corners.size());
  _edges = edgeSurface(space, surface, edges, corners);
  const auto masses = hostCopy(node_mass);
  const auto face_ids = hostCopy(surface.face_ids), face_body = hostCopy(surface.face_body);
  _corner_to_node = filled<View<int*>>(
      space, "contact::EdgeContact::corner_to_node",
      [&](auto& v) { std::copy(corners.begin(), corners.end(), v.data()); }, _num_corners);
  _corner_mass = filled<View<double*>>(
      space, "contact::EdgeContact::corner_mass",
      [&](auto& v) {
        for (int i = 0; i < _num_corners; ++i)
          v(i) = masses(corners[i]);
      },
      _num_corners);
  _records = filled<View<EdgeRecord*>>(
      space, "contact::EdgeContact::records",
      [&](auto& v) {
        for (int e = 0; e < _edges.num_faces; ++e) {
          const FeatureEdge& edge = edges.convex[e];
          v(e) = {{}, face_body(edge.face), 4 * face_ids(edge.face) + edge.edge};
        }
      },
      _edges.num_faces);
  const int num_nodes = _edges.num_nodes, num_edges = _edges.num_faces;
  _old = allocate<View<double* [3]>>(space, "contact::EdgeContact::x_old", num_nodes);
  _new = allocate<View<double* [3]>>(space, "contact::EdgeContact::x_new", num_nodes);
  _accelerations = View<double* [3]>("contact::EdgeContact::accelerations", num_nodes);
  _has_changed = View<unsigned char*>("contact::EdgeContact::has_changed", num_nodes);
  _touched = TouchedNodes("contact::EdgeContact", _num_corners);
  _ghost_accelerations = View<double* [12]>("contact::EdgeContact::ghost_accelerations", 0);
  _ghost_records = View<EdgeRecord*>("contact::EdgeContact::ghost_records", 0);
  _totals = View<std::int64_t* [3]>("contact::EdgeContact::totals", num_nodes);
  _returned = View<std::int64_t* [12]>("contact::EdgeContact::returned", num_edges);
  _edges.coordinates_old = _old;
  _edges.coordinates_new = _new;
  _set = InteractionSet(space, "contact::EdgeContact", _edges, 2, config, quantum);
  _still = StillParts("contact::EdgeContact", _edges, _corner_to_node);
  _sleeping = SleepingBlocks(space, "contact::EdgeContact", _edges.num_nodes);
}

void EdgeContact::gather(const exec_space& space, const Surface& surface) {
  const auto corner_to_node = _corner_to_node;
  const auto edge_to_nodes = _edges.face_to_nodes;
  const auto x_old = _old, x_new = _new;
  const int num_corners = _num_corners;
  const auto records = _records;
  Kokkos::parallel_for(
      "contact::EdgeContact::gatherCorners", over(space, num_corners),
      KOKKOS_LAMBDA(const std::int64_t i) {
        for (int d = 0; d < 3; ++d) {
          x_old(i, d) = surface.coordinates_old(corner_to_node(i), d);
          x_new(i, d) = surface.coordinates_new(corner_to_node(i), d);
        }
      });
  Kokkos::parallel_for(
      "contact::EdgeContact::sweepEdges", over(space, _edges.num_faces),
      KOKKOS_LAMBDA(const std::int64_t e) {
        const int a = edge_to_nodes(e, 0), b = edge_to_nodes(e, 1);
        for (int d = 0; d < 3; ++d) {
          const double over_old = EdgeTouch::overhang * (x_old(b, d) - x_old(a, d));
          const double over_new = EdgeTouch::overhang * (x_new(b, d) - x_new(a, d));
          const double ends[4] = {x_old(a, d) - over_old, x_old(b, d) + over_old,
                                  x_new(a, d) - over_new, x_new(b, d) + over_new};
          x_old(num_corners + e, d) = minOf(minOf(ends[0], ends[1]), minOf(ends[2], ends[3]));
          x_new(num_corners + e, d) = maxOf(maxOf(ends[0], ends[1]), maxOf(ends[2], ends[3]));
          records(e).end[0][d] = x_new(a, d);
          records(e).end[1][d] = x_new(b, d);
        }
      });
}

void EdgeContact::recordGhosts(const exec_space& space) {
  const FaceAccess faces = access();
  growTo(space, _ghost_records, faces.ghosts.count);
  const auto records = _ghost_records;
  Kokkos::parallel_for(
      "contact::EdgeContact::recordGhosts", over(space, faces.ghosts.count),
      KOKKOS_LAMBDA(const std::int64_t ghost) {
        const int edge = faces.surface.num_faces + static_cast<int>(ghost);
        EdgeRecord& record = records(ghost);
        for (int j = 0; j < 2; ++j) {
          const Vec3 x =
              faces.corner(edge, j, faces.surface.coordinates_new, faces.ghosts.coordinates_new);
          for (int d = 0; d < 3; ++d)
            record.end[j][d] = x[d];
        }
        record.body = faces.body(edge);
        record.id = faces.id(edge);
      });
}

void EdgeContact::findCandidates(const exec_space& space, const Surface& surface) {
  gather(space, surface);
  _search.update(space, _edges);
  if (_search.ghosts().count > 0)
    recordGhosts(space);
}

bool EdgeContact::leavesOutAll() const {
  return _search.ghosts().count == 0 && !_has_touched && _set.history().count == 0 &&
         (_still.isUnchanged() || _sleeping.numAwake() == 0);
}

ContactSums EdgeContact::select(const exec_space& space, double dt, const SurfaceMotion& motion) {
  const CandidatePairs& pairs = _search.pairs();
  if (_config.leaves_out_still) {
    _still.update(space, _edges, motion, pairs.step_test);
    _sleeping.wake(space, pairs, motion, _still.isUnchanged());
  }
  if (leavesOutAll()) {
    _set.selectNone(space, access());
    findTouched(space);
    return {};
  }
  SelectInteractions<EdgeTouch> select;
  select.energy_scale = _energy_scale;
  select.dt = dt;
  select.previous_dt = _previous_dt > 0 ? _previous_dt : dt;
  select.faces = access();
  select.first_row = _num_corners; // those of corners, which the searches list before
  select.still = _still.flags();
  select.sleep = _sleeping.state();
  select.has_asleep = _sleeping.hasAsleep();
  select.touch.lateral_tolerance = _config.lateral_tolerance;
  select.touch.edge_tolerance = _config.edge_tolerance;
  select.touch.num_corners = _num_corners;
  select.touch.node_mass = _corner_mass;
  select.touch.records = {_records, _ghost_records};
  select.touch.previous = _set.history().interactions;
  const ContactSums sums = _set.select(space, pairs, select);
  _has_touched = sums.touching > 0;
  if (_config.leaves_out_still)
    _sleeping.lull(space, select.touch, select.faces, pairs, motion, _set.next().row_count,
                   _still.flags().clear);
  findTouched(space);
  return sums;
}

void EdgeContact::collectForces(const exec_space& space, const View<std::int64_t* [3]>& nodes) {
  View<std::int64_t* [3]> of_corners = _set.forces().nodes;
  if (hasOtherRanks()) {
    Kokkos::deep_copy(space, _returned, 0);
    _search.returnToOwners(space, _set.forces().ghost_corners, _returned);
    Kokkos::deep_copy(space, _totals, of_corners);
    addFaceForces(space, _edges, _returned, _totals);
    of_corners = _totals;
  } else if (!_set.hasForces())
    return;
  const auto corner_to_node = _corner_to_node;
  const NodeList list = _touched.list();
  Kokkos::parallel_for(
      "contact::EdgeContact::toNodes", over(space, list.count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int corner = list(i);
        for (int d = 0; d < 3; ++d)
          nodes(corner_to_node(corner), d) += of_corners(corner, d); // no two corners are one node
      });
}

std::int64_t EdgeContact::correctForces(const exec_space& space, const StepLengths& steps,
                                        double relaxation,
                                        const View<double* [3]>& node_accelerations,
                                        const View<const unsigned char*>& node_has_changed) {
  if (!hasOtherRanks() && !_set.hasForces())
    return 0;
  const auto corner_to_node = _corner_to_node;
  const auto accelerations = _accelerations;
  const auto has_changed = _has_changed;
  const bool knows_changes = node_has_changed.extent(0) > 0;
  const NodeList list = _touched.list();
  Kokkos::parallel_for(
      "contact::EdgeContact::accelerations", over(space, list.count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int corner = list(i), node = corner_to_node(corner);
        for (int d = 0; d < 3; ++d)
          accelerations(corner, d) = node_accelerations(node, d);
        has_changed(corner) = knows_changes ? node_has_changed(node) : 1;
      });
  growTo(space, _ghost_accelerations, _search.ghosts().count);
  _search.sendToGhosts(space, _edges, _accelerations, _ghost_accelerations);
  return _set.correctForces(space, access(), steps, relaxation, _accelerations,
                            _ghost_accelerations,
                            knows_changes ? _has_changed : View<unsigned char*>());
}

// With ghosts, other ranks may act on any corner.
void EdgeContact::findTouched(const exec_space& space) {
  _touched.clear(space);
  if (hasOtherRanks())
    _touched.listAll(space);
  _touched.add(space, _edges, _set.next());
}

bool EdgeContact::hasOtherRanks() const {
  const auto statistics = _search.statistics();
  return statistics.num_ghosts > 0 || statistics.faces_sent > 0;
}

PairMotion EdgeContact::fastestPair(const exec_space& space, MPI_Comm comm, double limit) const {
  return fastestEdgePair(space, comm, _edges, _num_corners, _search.ghosts(), _search.pairs(),
                         limit);
}

void EdgeContact::advance(double dt) {
  _set.advance();
  _previous_dt = dt;
}

} // namespace brickwall::contact
