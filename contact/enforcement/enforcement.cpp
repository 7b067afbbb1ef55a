#include "contact/enforcement/enforcement.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "contact/enforcement/edge_edge/edge_contact.hpp"
#include "contact/enforcement/law/check_enforcement_input.hpp"
#include "contact/enforcement/node_face/find_joint_areas.hpp"
#include "contact/enforcement/node_face/node_face_separation.hpp"

namespace brickwall::contact {

namespace {

// Nodes that a kernel visits: the listed ones or, with marks [node], those of them that are marked.
struct MarkedNodes {
  NodeList list;
  View<unsigned char*> marks;

  // The node at a place, or -1.
  KOKKOS_FORCEINLINE_FUNCTION int operator()(std::int64_t place) const {
    const int node = list(place);
    return marks.extent(0) == 0 || marks(node) != 0 ? node : -1;
  }
};

// Accelerations by all forces: the given ones and the contact totals. Flags those that have changed
// since the last round, none `at_first`.
void accelerate(const exec_space& space, const MarkedNodes& nodes, bool at_first,
                const View<const double* [3]>& by_others,
                const View<std::int64_t* [3]>& contact_totals, const Quantum& quantum,
                const View<const double*>& node_mass, const View<double* [3]>& accelerations,
                const View<unsigned char*>& has_changed) {
  Kokkos::parallel_for(
      "contact::accelerate", rangePolicy(space, nodes.list.count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int node = nodes(i);
        if (node < 0)
          return;
        const double per_quantum = quantum.value / node_mass(node);
        double acceleration[3];
        bool is_same = true;
        for (int d = 0; d < 3; ++d) {
          acceleration[d] =
              by_others(node, d) + static_cast<double>(contact_totals(node, d)) * per_quantum;
          is_same &= sameBits(acceleration[d], accelerations(node, d));
        }
        has_changed(node) = !is_same && !at_first;
        if (is_same)
          return;
        for (int d = 0; d < 3; ++d)
          accelerations(node, d) = acceleration[d];
      });
}

// Responses of the nodes to the magnitudes of the proposed changes, which are zeroed with the marks.
void respond(const exec_space& space, const MarkedNodes& nodes,
             const View<std::int64_t* [3]>& totals, const Quantum& quantum,
             const View<const double*>& node_mass, const View<double* [3]>& responses) {
  Kokkos::parallel_for(
      "contact::respond", rangePolicy(space, nodes.list.count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int node = nodes(i);
        if (node < 0)
          return;
        if (nodes.marks.extent(0) > 0)
          nodes.marks(node) = 0;
        const double per_quantum = quantum.value / node_mass(node);
        for (int d = 0; d < 3; ++d) {
          const std::int64_t total = totals(node, d);
          responses(node, d) = static_cast<double>(total) * per_quantum;
          if (total != 0)
            totals(node, d) = 0;
        }
      });
}

// totals = forces at the listed nodes.
void copyTotals(const exec_space& space, const NodeList& list,
                const View<std::int64_t* [3]>& forces, const View<std::int64_t* [3]>& totals) {
  Kokkos::parallel_for(
      "contact::copyTotals", rangePolicy(space, list.count), KOKKOS_LAMBDA(const std::int64_t i) {
        for (int d = 0; d < 3; ++d)
          totals(list(i), d) = forces(list(i), d);
      });
}

Communicator checkedCopy(const exec_space& space, MPI_Comm comm, const Surface& surface,
                         const View<const double*>& node_mass, const EnforcementConfig& config,
                         const Quantum& quantum, const LimbScale& energy_scale) {
  checkEnforcementInput(space, comm, "Enforcement", surface, node_mass, config, quantum,
                        energy_scale);
  return Communicator(comm);
}

} // namespace

Enforcement::Enforcement(const exec_space& space, MPI_Comm comm, const Surface& surface,
                         const View<const double*>& node_mass, const EnforcementConfig& config,
                         const Quantum& quantum, const LimbScale& energy_scale)
    : _comm(checkedCopy(space, comm, surface, node_mass, config, quantum, energy_scale)),
      _num_nodes(surface.num_nodes), _num_faces(surface.num_faces), _config(config),
      _quantum(quantum), _node_mass(node_mass), _node_faces(space, _comm, surface),
      _records(space, surface, _node_faces),
      _has_sought_joints(config.scheme != Scheme::energy_neutral),
      _set(space, "contact::Enforcement", surface, surface.num_nodes, 4, config, quantum,
           energy_scale),
      _motion(space, "contact::Enforcement", surface),
      _idle(space, "contact::Enforcement", surface) {
  _totals = View<std::int64_t* [3]>("contact::Enforcement::forces", surface.num_nodes);
  _forces.nodes = _totals;
  _touched = TouchedNodes("contact::Enforcement", surface.num_nodes);
  _status = View<int*>("contact::Enforcement::status", surface.num_nodes);
  _gap = View<double*>("contact::Enforcement::gap", surface.num_nodes);
  Kokkos::deep_copy(space, _gap, -0.0);
  _set.recordIn(_status, _gap);
  _accelerations =
      View<double* [3]>("contact::Enforcement::accelerations",
                        config.scheme == Scheme::energy_neutral ? surface.num_nodes : 0);
  _has_changed =
      View<unsigned char*>("contact::Enforcement::has_changed", _accelerations.extent(0));
  _is_proposed =
      View<unsigned char*>("contact::Enforcement::is_proposed", _accelerations.extent(0));
  _ghost_in_use = View<unsigned char*>("contact::Enforcement::ghost_in_use", 0);
  _ghost_accelerations = View<double* [12]>("contact::Enforcement::ghost_accelerations", 0);
  _responses = View<double* [3]>("contact::Enforcement::responses", _accelerations.extent(0));
  _ghost_responses = View<double* [12]>("contact::Enforcement::ghost_responses", 0);
}

EnforcementSums Enforcement::enforce(const exec_space& space, const Surface& surface,
                                     const GhostFaces& ghosts, const CandidatePairs& pairs,
                                     const StepLengths& steps, const NeutralInput* neutral,
                                     EdgeContact* edges) {
  Region region("contact::enforce");
  const std::string problem = problemOf(surface, pairs, neutral);
  if (!problem.empty())
    throwWithAllRanks(space, problem);
  const FaceAccess faces{surface, ghosts};
  if (_config.skip_stationary) {
    _motion.update(space, surface); // waits for the device
    _idle.update(space, surface, _motion, pairs, ghosts.count > 0);
  } else if (edges != nullptr) {
    space.fence(); // select() of edges reads what was launched
  }
  EnforcementSums sums = select(space, faces, pairs, steps.dt, edges);
  const bool had_forces = _has_forces;
  agreeOnForces(sums, edges);
  if (!_has_sought_joints) {
    _joints = findJointAreas(space, _comm, kinematicsOf(faces), faces, pairs, *neutral);
    _has_sought_joints = true;
  }
  if (_has_forces || had_forces)
    findTouched(space, faces, neutral, edges);
  _has_totals = false;
  if (_has_forces && _config.scheme == Scheme::energy_neutral)
    correctEnergy(space, faces, steps, neutral, edges, sums);
  if (!_has_forces && !had_forces)
    _forces.ghost_corners = _set.forces().ghost_corners;
  else if (!_has_totals)
    collectForces(space, edges);
  _set.advance(steps.dt);
  if (edges != nullptr)
    edges->advance(steps.dt);
  return sums;
}

void Enforcement::restore(const exec_space& space, const Surface& surface,
                          const ContactCarry& carry) {
  _set.restore(space, surface.node_ids, carry, atNode);
  _has_forces = carry.has_forces;
  _joints = jointAreasOf(space, surface.node_ids, carry.joints);
  _has_sought_joints = true;
}

void Enforcement::addWork(const exec_space& space, const CandidatePairs& pairs,
                          const View<std::int64_t**>& work) const {
  const RowWork of_row{pairs, history().row_count, _idle.state()};
  Kokkos::parallel_for(
      "contact::Enforcement::addWork", rangePolicy(space, pairs.num_rows),
      KOKKOS_LAMBDA(const std::int64_t row) { work(of_row.pairs.node(row), 0) += of_row(row); });
}

bool Enforcement::isOnAnyRank(bool here) const {
  return sizeOf(_comm) > 1 ? allReduce(_comm, here ? 1 : 0, MPI_MAX) > 0 : here;
}

std::string Enforcement::problemOf(const Surface& surface, const CandidatePairs& pairs,
                                   const NeutralInput* neutral) const {
  if (_config.scheme == Scheme::energy_neutral && (neutral == nullptr || !neutral->isComplete()))
    return "Enforcement::enforce: rank " + std::to_string(rankOf(_comm)) +
           " has no complete NeutralInput, which Scheme::energy_neutral needs; expected all of its "
           "functions, or Scheme::penalty";
  if (surface.num_nodes == _num_nodes && surface.num_faces == _num_faces &&
      pairs.num_rows == _num_nodes)
    return {};
  return "Enforcement::enforce: rank " + std::to_string(rankOf(_comm)) + " has " +
         std::to_string(surface.num_nodes) + " nodes, " + std::to_string(surface.num_faces) +
         " faces and " + std::to_string(pairs.num_rows) + " rows of candidates; expected " +
         std::to_string(_num_nodes) + ", " + std::to_string(_num_faces) + " and " +
         std::to_string(_num_nodes) + ", as in the constructor";
}

// The other ranks wait for messages in their step: this one takes part up to the reduction by which
// all learn of it.
void Enforcement::throwWithAllRanks(const exec_space& space, const std::string& problem) {
  _node_faces.exchangeNothing(space);
  agreeOnForces({}, nullptr, problem);
}

void Enforcement::agreeOnForces(const EnforcementSums& sums, EdgeContact* edges,
                                const std::string& problem) {
  int any[3] = {sums.nodes.interactions + sums.edges.interactions > 0, sums.edges.interactions > 0,
                !problem.empty()};
  if (sizeOf(_comm) > 1)
    allReduce(_comm, any, 3, MPI_MAX);
  if (any[2] != 0)
    rethrowOnAllRanks(_comm, [&] {
      if (!problem.empty())
        throw InputError(problem);
    });
  _has_forces = any[0] != 0;
  if (edges != nullptr)
    edges->setHasForcesAnywhere(any[1] != 0);
}

// On several ranks, faces around a node may belong to others and move, and their areas are
// exchanged.
bool Enforcement::canSkipAll() const {
  return sizeOf(_comm) == 1 && !_has_status && _set.history().count == 0 && _idle.areAll();
}

NodeFaceKinematics Enforcement::kinematicsOf(const FaceAccess& faces) const {
  NodeFaceKinematics kinematics;
  kinematics.lateral_tolerance = _config.lateral_tolerance;
  kinematics.edge_tolerance = _config.edge_tolerance;
  kinematics.opposed_cosine = _config.opposed_cosine;
  kinematics.shared_cosine = _config.shared_cosine;
  kinematics.least_depth = _config.least_depth;
  kinematics.adjacent_faces = _node_faces.lists();
  kinematics.records = _records.records();
  kinematics.num_faces = faces.surface.num_faces;
  kinematics.num_remote = _node_faces.numRemote();
  kinematics.node_mass = _node_mass;
  kinematics.joints = _joints;
  kinematics.status = _status;
  kinematics.gap = _gap;
  return kinematics;
}

// The contacts of edges are selected beside those of nodes.
EnforcementSums Enforcement::select(const exec_space& space, const FaceAccess& faces,
                                    const CandidatePairs& pairs, double dt, EdgeContact* edges) {
  std::function<ContactSums()> selected_nodes, selected_edges;
  if (_has_sought_joints && canSkipAll()) {
    _set.selectNone(space, faces);
    if (!_idle.isUnchanged())
      _records.invalidate(space);
  } else {
    _records.update(space, faces, pairs, _idle, _node_faces);
    selected_nodes = selectNodes(space, faces, pairs, dt);
  }
  if (edges != nullptr)
    selected_edges = edges->select(space, dt, _motion);
  EnforcementSums sums;
  if (selected_nodes)
    sums.nodes = selected_nodes();
  if (selected_edges)
    sums.edges = selected_edges();
  return sums;
}

std::function<ContactSums()> Enforcement::selectNodes(const exec_space& space,
                                                      const FaceAccess& faces,
                                                      const CandidatePairs& pairs, double dt) {
  const NodeFaceKinematics kinematics = kinematicsOf(faces);
  return [this, space, faces, pairs, kinematics,
          finish = _set.select(space, kinematics, faces, pairs, _idle.state(), dt)] {
    const ContactSums sums = finish();
    _has_status = sums.penetrating > 0;
    if (_config.skip_stationary)
      _idle.putToSleep(space, kinematics, faces, pairs, _motion, _set.next().row_count);
    return sums;
  };
}

void Enforcement::findTouched(const exec_space& space, const FaceAccess& faces,
                              const NeutralInput* neutral, EdgeContact* edges) {
  const bool were_all = _touched.list().isAll();
  if (!were_all)
    zeroListed(space, "contact::zeroTotals", _touched.list(), _totals);
  _touched.clear(space);
  _touched.add(space, faces.surface, _set.next());
  if (edges != nullptr)
    edges->addTouched(space, _touched);
  if (sizeOf(_comm) > 1 && (neutral == nullptr || !neutral->list_shared))
    _touched.listAll(space);
  else if (sizeOf(_comm) > 1)
    neutral->list_shared(
        [&] {
          growTo(space, _ghost_in_use, faces.ghosts.count);
          flagGhostsInUse(space, faces, _set.next(), _ghost_in_use);
          return _ghost_in_use;
        },
        _touched);
  if (were_all && !_touched.list().isAll())
    zeroListed(space, "contact::zeroTotals", NodeList::allOf(_num_nodes), _totals);
}

// forces() = those of the nodes and edges of this rank.
void Enforcement::collectForces(const exec_space& space, EdgeContact* edges) {
  const auto of_set = _set.forces().nodes;
  _forces.ghost_corners = _set.forces().ghost_corners;
  _forces.nodes = of_set;
  if (sizeOf(_comm) == 1 && (edges == nullptr || !edges->hasForces()))
    return; // no forces of edges or of other ranks to add
  _forces.nodes = _totals;
  copyTotals(space, _touched.list(), of_set, _totals);
  if (edges != nullptr)
    edges->collectForces(space, _forces.nodes);
}

void Enforcement::correctEnergy(const exec_space& space, const FaceAccess& faces,
                                const StepLengths& steps, const NeutralInput* neutral,
                                EdgeContact* edges, EnforcementSums& sums) {
  growTo(space, _ghost_accelerations, faces.ghosts.count);
  growTo(space, _ghost_responses, faces.ghosts.count);
  const View<const double* [3]> by_others = neutral->accelerations(_touched.list());
  // Other ranks do not know which nodes are marked here.
  const bool has_marks = sizeOf(_comm) == 1;
  const View<unsigned char*> none;
  const auto marks_changed = has_marks ? _has_changed : none;
  const auto marks_proposed = has_marks ? _is_proposed : none;
  for (int round = 0; round < _config.corrections; ++round) {
    collectForces(space, edges);
    if (edges != nullptr && has_marks && round > 0)
      edges->markTouched(space, _has_changed);
    neutral->sum_forces(_forces);
    _has_totals = true;
    accelerate(space, {_touched.list(), round > 0 ? marks_changed : none}, round == 0, by_others,
               _forces.nodes, _quantum, _node_mass, _accelerations, _has_changed);
    neutral->share_with_ghosts(_accelerations, _ghost_accelerations);
    const NodeVectors accelerations{_accelerations, _ghost_accelerations};
    const auto has_changed = round > 0 ? _has_changed : View<unsigned char*>();
    _set.proposeChanges(space, faces, steps, accelerations, has_changed, marks_proposed);
    if (edges != nullptr)
      edges->proposeChanges(space, steps, _accelerations, has_changed);
    if (!mayHaveProposals(space, edges))
      break;
    const ContactForces proposals = _set.proposals();
    if (edges != nullptr)
      edges->collectProposals(space, proposals.nodes);
    if (edges != nullptr && has_marks)
      edges->markTouched(space, _is_proposed);
    neutral->sum_forces(proposals);
    respond(space, {_touched.list(), marks_proposed}, proposals.nodes, _quantum, _node_mass,
            _responses);
    neutral->share_with_ghosts(_responses, _ghost_responses);
    const NodeVectors responses{_responses, _ghost_responses};
    _has_totals = false;
    _set.correctForces(space, faces, steps, accelerations, responses, marks_changed);
    if (edges != nullptr)
      edges->correctForces(space, steps, _responses);
  }
  if (!_has_totals) { // otherwise they have been read since the last correction
    _set.sendNotes(space);
    if (edges != nullptr)
      edges->sendNotes(space);
  }
  if (!neutral->completes_sums)
    completeSums(space, edges, sums);
}

void Enforcement::completeSums(const exec_space& space, EdgeContact* edges, EnforcementSums& sums) {
  sums.nodes.invalid += _set.takeInvalid(space);
  if (edges != nullptr)
    sums.edges.invalid += edges->takeInvalid(space);
}

// Rounds without proposals change nothing. One rank with a device makes them all the same: to ask
// would be to wait for the device.
bool Enforcement::mayHaveProposals(const exec_space& space, EdgeContact* edges) {
  if (!host_accessible && sizeOf(_comm) == 1)
    return true;
  return isOnAnyRank(_set.hasProposals(space) || (edges != nullptr && edges->hasProposals(space)));
}

} // namespace brickwall::contact
