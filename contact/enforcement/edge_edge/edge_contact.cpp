#include "contact/enforcement/edge_edge/edge_contact.hpp"

#include "contact/base/region.hpp"
#include "contact/enforcement/edge_edge/edge_separation.hpp"
#include "contact/enforcement/law/check_enforcement_input.hpp"

namespace brickwall::contact {
namespace {

using StagedNumber = Kokkos::View<double, staging_space>;

// Whether both configurations of a node are those of the last step; none are without flags.
struct RestingNodes {
  View<const unsigned char*> stationary;

  KOKKOS_INLINE_FUNCTION bool operator()(int node) const {
    return stationary.extent(0) > 0 && stationary(node) == SurfaceMotion::twice;
  }
};

// Gathers the coordinates of the corners (x_old, x_new) [corner][xyz] that are not at rest.
// `excursion` is the largest one of these outside `boxes`, those of the last search.
void gatherCorners(const exec_space& space, const Surface& surface,
                   const View<const int*>& corner_to_node, const View<const double* [6]>& boxes,
                   const RestingNodes& is_at_rest, const View<double* [3]>& x_old,
                   const View<double* [3]>& x_new, const StagedNumber& excursion) {
  const bool has_boxes = boxes.extent(0) > 0;
  Kokkos::parallel_reduce(
      "contact::EdgeContact::gatherCorners",
      rangePolicy(space, static_cast<std::int64_t>(corner_to_node.extent(0))),
      KOKKOS_LAMBDA(const std::int64_t i, double& largest) {
        const int node = corner_to_node(i);
        if (is_at_rest(node))
          return;
        const Vec3 before = rowOf(surface.coordinates_old, node);
        const Vec3 now = rowOf(surface.coordinates_new, node);
        for (int d = 0; d < 3; ++d) {
          x_old(i, d) = before[d];
          x_new(i, d) = now[d];
        }
        if (has_boxes)
          largest = maxOf(largest, excursionOutside(boxes, i, before, now));
      },
      Kokkos::Max<double, staging_space>(excursion));
}

// Computes the swept box of each edge, stored as the coordinates of node num_corners + edge (low
// corner as x_old, high corner as x_new), and the ends of the edges. `excursion` as above.
void sweepEdges(const exec_space& space, int num_edges, int num_corners,
                const View<const int* [4]>& edge_to_nodes, const View<const int*>& corner_to_node,
                const View<const double* [6]>& boxes, const RestingNodes& is_at_rest,
                const View<double* [3]>& x_old, const View<double* [3]>& x_new,
                const View<EdgeRecord*>& records, const StagedNumber& excursion) {
  const bool has_boxes = boxes.extent(0) > 0;
  Kokkos::parallel_reduce(
      "contact::EdgeContact::sweepEdges", rangePolicy(space, num_edges),
      KOKKOS_LAMBDA(const std::int64_t e, double& largest) {
        const int a = edge_to_nodes(e, 0), b = edge_to_nodes(e, 1);
        if (is_at_rest(corner_to_node(a)) && is_at_rest(corner_to_node(b)))
          return;
        Vec3 low, high;
        for (int d = 0; d < 3; ++d) {
          const double over_old = EdgeEdgeKinematics::overhang * (x_old(b, d) - x_old(a, d));
          const double over_new = EdgeEdgeKinematics::overhang * (x_new(b, d) - x_new(a, d));
          const double ends[4] = {x_old(a, d) - over_old, x_old(b, d) + over_old,
                                  x_new(a, d) - over_new, x_new(b, d) + over_new};
          low[d] = minOf(minOf(ends[0], ends[1]), minOf(ends[2], ends[3]));
          high[d] = maxOf(maxOf(ends[0], ends[1]), maxOf(ends[2], ends[3]));
          x_old(num_corners + e, d) = low[d];
          x_new(num_corners + e, d) = high[d];
          records(e).end[0][d] = x_new(a, d);
          records(e).end[1][d] = x_new(b, d);
        }
        if (has_boxes)
          largest = maxOf(largest, excursionOutside(boxes, num_corners + e, low, high));
      },
      Kokkos::Max<double, staging_space>(excursion));
}

void recordGhosts(const exec_space& space, const FaceAccess& faces,
                  const View<EdgeRecord*>& records) {
  Kokkos::parallel_for(
      "contact::EdgeContact::recordGhosts", rangePolicy(space, faces.ghosts.count),
      KOKKOS_LAMBDA(const std::int64_t ghost) {
        const int edge = faces.surface.num_faces + static_cast<int>(ghost);
        EdgeRecord& record = records(ghost);
        for (int j = 0; j < 2; ++j) {
          const Vec3 x =
              faces.corner(edge, j, faces.surface.coordinates_new, faces.ghosts.coordinates_new);
          for (int d = 0; d < 3; ++d)
            record.end[j][d] = x[d];
        }
        record.side = faces.side(edge);
        record.id = faces.id(edge);
      });
}

// nodes += of_corners at the nodes of the listed corners, which are distinct.
void addCorners(const exec_space& space, const NodeList& list,
                const View<const int*>& corner_to_node, const View<std::int64_t* [3]>& of_corners,
                const View<std::int64_t* [3]>& nodes) {
  Kokkos::parallel_for(
      "contact::EdgeContact::toNodes", rangePolicy(space, list.count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int corner = list(i);
        for (int d = 0; d < 3; ++d)
          nodes(corner_to_node(corner), d) += of_corners(corner, d);
      });
}

// of_corners = of_nodes at the listed corners.
void gatherVectors(const exec_space& space, const NodeList& list,
                   const View<const int*>& corner_to_node, const View<const double* [3]>& of_nodes,
                   const View<double* [3]>& of_corners) {
  Kokkos::parallel_for(
      "contact::EdgeContact::gatherVectors", rangePolicy(space, list.count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int corner = list(i), node = corner_to_node(corner);
        for (int d = 0; d < 3; ++d)
          of_corners(corner, d) = of_nodes(node, d);
      });
}
void gatherFlags(const exec_space& space, const NodeList& list,
                 const View<const int*>& corner_to_node, const View<const unsigned char*>& of_nodes,
                 const View<unsigned char*>& of_corners) {
  Kokkos::parallel_for(
      "contact::EdgeContact::gatherFlags", rangePolicy(space, list.count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        of_corners(list(i)) = of_nodes(corner_to_node(list(i)));
      });
}

} // namespace

EdgeContact::EdgeContact(const exec_space& space, MPI_Comm comm, const Surface& surface,
                         const FeatureEdges& edges, const View<const double*>& node_mass,
                         const SearchConfig& search, double margin, const EnforcementConfig& config,
                         const Quantum& quantum, const LimbScale& energy_scale)
    : _beside(queueBeside(space)), _search(comm, search, margin), _config(config) {
  checkEnforcementInput(space, comm, "EdgeContact", surface, node_mass, config, quantum,
                        energy_scale);
  _config.max_activation_depth = HUGE_VAL; // edges have bounds of their own
  const EdgeSurface made = edgeSurface(space, surface, edges, node_mass);
  _edges = made.surface;
  _num_corners = made.num_corners;
  _corner_to_node = made.corner_to_node;
  _edge_to_nodes = made.edge_to_nodes;
  _corner_mass = made.corner_mass;
  _records = made.records;
  const int num_nodes = _edges.num_nodes;
  _old = allocate<View<double* [3]>>(space, "contact::EdgeContact::x_old", num_nodes);
  _new = allocate<View<double* [3]>>(space, "contact::EdgeContact::x_new", num_nodes);
  for (auto& excursion : _excursion)
    excursion = StagedNumber("contact::EdgeContact::excursion");
  const int num_corrected = config.scheme == Scheme::energy_neutral ? _num_corners : 0;
  _accelerations = View<double* [3]>("contact::EdgeContact::accelerations", num_corrected);
  _has_changed = View<unsigned char*>("contact::EdgeContact::has_changed", num_corrected);
  _touched = TouchedNodes("contact::EdgeContact", _num_corners);
  _ghost_in_use = View<unsigned char*>("contact::EdgeContact::ghost_in_use", 0);
  _ghost_accelerations = View<double* [12]>("contact::EdgeContact::ghost_accelerations", 0);
  _responses = View<double* [3]>("contact::EdgeContact::responses", num_corrected);
  _ghost_responses = View<double* [12]>("contact::EdgeContact::ghost_responses", 0);
  _ghost_records = View<EdgeRecord*>("contact::EdgeContact::ghost_records", 0);
  _edges.coordinates_old = _old;
  _edges.coordinates_new = _new;
  _set = InteractionSet(space, "contact::EdgeContact", _edges, _num_corners, 2, _config, quantum,
                        energy_scale);
  _idle = IdleRows(space, "contact::EdgeContact", _edges, _corner_to_node);
}

// Also measures the largest excursions outside the boxes of the last search, since the coordinates
// are at hand here.
void EdgeContact::gatherCoordinates(const exec_space& space, const Surface& surface,
                                    const View<const unsigned char*>& stationary) {
  const View<const double* [6]> boxes = _search.sweptBoxes();
  const RestingNodes is_at_rest{_has_gathered ? stationary : View<const unsigned char*>()};
  _has_gathered = true;
  gatherCorners(space, surface, _corner_to_node, boxes, is_at_rest, _old, _new, _excursion[0]);
  sweepEdges(space, _edges.num_faces, _num_corners, _edges.face_to_nodes, _corner_to_node, boxes,
             is_at_rest, _old, _new, _records, _excursion[1]);
}

void EdgeContact::findCandidates(const exec_space& space) {
  space.fence();
  _search.update(space, _edges, maxOf(_excursion[0](), _excursion[1]()));
  if (_search.ghosts().count == 0)
    return;
  growTo(space, _ghost_records, _search.ghosts().count);
  recordGhosts(space, access(), _ghost_records);
}

bool EdgeContact::canSkipAll() const {
  return _search.ghosts().count == 0 && !_has_touched && _set.history().count == 0 &&
         _idle.areAll();
}

std::function<ContactSums()> EdgeContact::select(const exec_space& space, double dt,
                                                 const SurfaceMotion& motion) {
  const CandidatePairs& pairs = _search.pairs();
  if (_config.skip_stationary)
    _idle.update(_beside, _edges, motion, pairs, _search.ghosts().count > 0);
  if (canSkipAll()) {
    _beside.fence();
    _set.selectNone(space, access());
    findTouched(space);
    return [] { return ContactSums(); };
  }
  EdgeEdgeKinematics kinematics;
  kinematics.lateral_tolerance = _config.lateral_tolerance;
  kinematics.edge_tolerance = _config.edge_tolerance;
  kinematics.num_corners = _num_corners;
  kinematics.node_mass = _corner_mass;
  kinematics.records = {_records, _ghost_records};
  kinematics.previous = _set.history().interactions;
  const FaceAccess faces = access();
  // The searches list the rows of corners first, which have no candidates.
  return
      [this, space, kinematics, faces, &pairs, &motion,
       finish = _set.select(_beside, kinematics, faces, pairs, _idle.state(), dt, _num_corners)] {
        const ContactSums sums = finish();
        _has_touched = sums.penetrating > 0;
        if (_config.skip_stationary)
          _idle.putToSleep(space, kinematics, faces, pairs, motion, _set.next().row_count);
        findTouched(space);
        return sums;
      };
}

void EdgeContact::collectForces(const exec_space& space, const View<std::int64_t* [3]>& nodes) {
  if (_has_forces_anywhere)
    addToNodes(space, _set.forces(), nodes);
}

void EdgeContact::collectProposals(const exec_space& space, const View<std::int64_t* [3]>& nodes) {
  if (canSkipCorrection())
    return;
  addToNodes(space, _set.proposals(), nodes);
  zeroListed(space, "contact::EdgeContact::zeroCorners", _touched.list(), _set.proposals().nodes);
}

void EdgeContact::addToNodes(const exec_space& space, const ContactForces& values,
                             const View<std::int64_t* [3]>& nodes) {
  if (hasOtherRanks())
    _search.reverseSumSelected(space, _edge_to_nodes, values.ghost_corners, nodes);
  if (_set.hasForces())
    addCorners(space, _touched.list(), _corner_to_node, values.nodes, nodes);
}

void EdgeContact::markTouched(const exec_space& space, const View<unsigned char*>& marks) const {
  if (canSkipCorrection() || !_set.hasForces())
    return;
  const NodeList list = _touched.list();
  const auto corner_to_node = _corner_to_node;
  Kokkos::parallel_for(
      "contact::EdgeContact::markTouched", rangePolicy(space, list.count),
      KOKKOS_LAMBDA(const std::int64_t i) { marks(corner_to_node(list(i))) = 1; });
}

void EdgeContact::proposeChanges(const exec_space& space, const StepLengths& steps,
                                 const View<double* [3]>& node_accelerations,
                                 const View<const unsigned char*>& node_has_changed) {
  if (canSkipCorrection())
    return;
  toCorners(space, node_accelerations, _accelerations, _ghost_accelerations);
  const bool has_change_flags = node_has_changed.extent(0) > 0;
  if (has_change_flags)
    gatherFlags(space, _touched.list(), _corner_to_node, node_has_changed, _has_changed);
  _set.proposeChanges(space, access(), steps, {_accelerations, _ghost_accelerations},
                      has_change_flags ? _has_changed : View<unsigned char*>());
}

void EdgeContact::correctForces(const exec_space& space, const StepLengths& steps,
                                const View<double* [3]>& node_responses) {
  if (canSkipCorrection())
    return;
  toCorners(space, node_responses, _responses, _ghost_responses);
  _set.correctForces(space, access(), steps, {_accelerations, _ghost_accelerations},
                     {_responses, _ghost_responses});
}

void EdgeContact::toCorners(const exec_space& space, const View<double* [3]>& of_nodes,
                            const View<double* [3]>& own, View<double* [12]>& of_ghosts) {
  gatherVectors(space, _touched.list(), _corner_to_node, of_nodes, own);
  growTo(space, of_ghosts, _search.ghosts().count);
  _search.forwardSelected(space, _edges, own, of_ghosts);
}

// Those of this rank's contacts.
void EdgeContact::findTouched(const exec_space& space) {
  _touched.clear(space);
  _touched.add(space, _edges, _set.next());
}

void EdgeContact::addTouched(const exec_space& space, TouchedNodes& of_surface) {
  if (!_has_forces_anywhere)
    return;
  growTo(space, _ghost_in_use, _search.ghosts().count);
  flagGhostsInUse(space, access(), _set.next(), _ghost_in_use);
  _search.selectGhosts(space, _ghost_in_use);
  const GhostSelection& sent = _search.selection();
  _touched.addCorners(space, sent.faces(), sent.numFaces(), _edges.face_to_nodes);
  of_surface.add(space, _edges, _set.next(), _corner_to_node);
  of_surface.addCorners(space, sent.faces(), sent.numFaces(), _edge_to_nodes);
}

// Partners, with or without ghosts, wait for each other's messages.
bool EdgeContact::hasOtherRanks() const {
  return _search.statistics().num_partners > 0;
}

PairMotion EdgeContact::fastestPair(const exec_space& space, MPI_Comm comm, const Vec3& mean,
                                    double limit) {
  return _fastest_pair.findEdges(space, comm, _edges, _num_corners, _search.ghosts(),
                                 _search.pairs(), mean, limit);
}

void EdgeContact::restore(const exec_space& space, const ContactCarry& carry) {
  const auto edge_to_nodes = toHost(_edges.face_to_nodes);
  _set.restore(space, _edges.node_ids, carry, [&](int row) {
    ContactPoint point;
    for (int end = 0; end < 2; ++end)
      point.node[end] = edge_to_nodes(row - _num_corners, end);
    return point;
  });
  _has_forces_anywhere = carry.has_forces;
}

void EdgeContact::addWork(const exec_space& space, const View<std::int64_t**>& work) const {
  const RowWork of_row{_search.pairs(), history().row_count, _idle.state()};
  const auto edge_to_nodes = _edge_to_nodes;
  const int num_corners = _num_corners;
  Kokkos::parallel_for(
      "contact::EdgeContact::addWork", rangePolicy(space, of_row.pairs.num_rows),
      KOKKOS_LAMBDA(const std::int64_t row) {
        const int edge = of_row.pairs.node(row) - num_corners; // corners have no candidates
        if (edge >= 0)
          Kokkos::atomic_add(&work(edge_to_nodes(edge, 0), 0), of_row(row));
      });
}

} // namespace brickwall::contact
