#include "miniapp/simulation.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "mechanics/central_difference.hpp"
#include "mechanics/lumped_mass.hpp"
#include "mechanics/stable_time_step.hpp"
#include "miniapp/initial_overlaps.hpp"
#include "miniapp/loads.hpp"
#include "miniapp/search_choice.hpp"
#include "miniapp/undo_step.hpp"

#include <cmath>
#include <sstream>

namespace brickwall::miniapp {

namespace {

// Of StepCounts::host: ranks with a penetration beyond a limit.
enum HostCount : int { deeper_than_warned, deeper_than_allowed, deeper_than_boxes };
static_assert(deeper_than_boxes < mechanics::num_host_counts);

std::string reversingDamping(double damping, double dt) {
  std::ostringstream message;
  message << "damping.mass: found " << damping << ", which reverses all motion in every step of "
          << dt << "; expected less than 2 over the step, " << 2 / dt;
  return message.str();
}

} // namespace

void Simulation::step() {
  moveNodes();
  findContactCandidates();
  guardAgainstTunnelling();
  auditCandidates();
  adaptTimeStep();
  computeForces(_clock.time);
  watchCompression();
  sumSharedNodes();
  enforceContact(_clock.dt_before);
  kickVelocities(0.5 * (_clock.dt_before + _clock.dt), _clock.time + 0.5 * _clock.dt);
  bookEnergies(0.5 * (_clock.dt_before + _clock.dt));
}

void Simulation::start() {
  findContactCandidates();
  auditCandidates();
  computeForces(_clock.time);
  watchCompression();
  sumSharedNodes();
  enforceContact(_clock.dt);
  kickVelocities(0.5 * _clock.dt, 0.5 * _clock.dt);
  bookEnergies(0.5 * _clock.dt);
}

void Simulation::moveNodes() {
  keepPositionsWhereFast();
  const Region region("step::drift");
  // Free bricks drift while they are swept, unless someone looks at the positions before.
  _free_have_drifted = _free_bricks.any() && checksStableStep(_clock.step + 1);
  if (_free_have_drifted || movingNodes().all || !host_accessible)
    mechanics::drift(_space, _clock.dt, _state);
  else
    mechanics::drift(_space, _clock.dt, _state, movingNodes());
  if (_coupling)
    _coupling->gatherCoordinates(_space, _state.displacement);
  _clock.advance();
}

void Simulation::findContactCandidates() {
  if (!_coupling)
    return;
  const Region region("search");
  reachAsDeepAsContacts();
  _search->update(_space, _coupling->surface());
  if (_edges)
    _edges->findCandidates(_space, _coupling->surface());
}

void Simulation::auditCandidates() {
  if (!_coupling || _config.search.audit == 0 || _clock.step % _config.search.audit != 0)
    return;
  const Region region("step::audit of pairs");
  _missed_pairs += _search->countMissedPairs(_space, _coupling->surface());
  if (_edges)
    _missed_pairs += _edges->countMissedPairs(_space);
}

// Boxes of node and face together reach as far as the deepest loaded contact may fade out beyond an edge (twice its depth, and a
// little), but no farther than the shortest edge: a node that is pressed in deep keeps its faces. They grow with some reserve and
// shrink late, so that lists that are kept stay of use.
double Simulation::reachOf(double deepest) const {
  const double wanted =
      0.5 * (2.2 * deepest + 0.1 * _config.contact.edge_tolerance * _scene.longest_edge);
  return deepest > 0 ? minOf(wanted, 0.5 * _scene.shortest_edge) : 0;
}
void Simulation::reachAsDeepAsContacts() {
  if (_ledger.balance().host_counts[deeper_than_boxes] == 0 && _reach == _box_tolerance)
    return;
  const double deepest = maxOf(_contact.nodes.deepest, _contact.edges.deepest);
  const double wanted = reachOf(allReduce(_comm, deepest, MPI_MAX));
  if (wanted > _reach)
    _reach = 1.25 * wanted;
  else if (wanted < 0.5 * _reach)
    _reach = maxOf(_box_tolerance, wanted);
  _search->setTolerances(_reach, _reach);
  if (_edges)
    _edges->setTolerance(_reach);
}

void Simulation::computeForces(double time) {
  _has_all_forces = !_free_bricks.any();
  if (_other_nodes.numRuns() > 0)
    mechanics::zeroForces(_space, _forces);
  else
    _forces.values = View<std::int64_t**>(); // needed for output only
  {
    const Region region("step::internal force");
    _resting_elems = _resting.numElems();
    _internal = _internal_force->add(_space, _state.displacement, _state.velocity,
                                     _config.viscosity, _forces, true);
  }
  const Region region("step::loads");
  _load_failures = 0;
  for (const auto& load : _loads)
    _load_failures += load.add(_space, _scene.mesh, _state.displacement, time, _forces);
}

void Simulation::sumSharedNodes() {
  const Region region("step::shared-node sum");
  _shared.sum(_space, _forces.values);
}

void Simulation::enforceContact(double dt) {
  if (!_enforcement)
    return;
  const Region region("step::contact enforcement");
  const contact::Surface surface = _coupling->surface();
  const auto sum_forces = [&](const contact::ContactForces& forces) {
    _coupling->sumContactForces(_space, forces, *_search, _shared);
  };
  contact::NeutralInput neutral;
  if (_config.contact.scheme == ContactScheme::energy_neutral) {
    neutral.accelerations = [&] {
      return _coupling->accelerations(_space, _forces, _state, 0.5 * (dt + _clock.dt), _boundary);
    };
    neutral.sum_forces = sum_forces;
    neutral.share_with_ghosts = [&](const View<const double* [3]>& values,
                                    const View<double* [12]>& ghost_values) {
      _search->sendToGhosts(_space, surface, values, ghost_values);
    };
  }
  _contact = _enforcement->enforce(_space, surface, _search->ghosts(), _search->pairs(),
                                   {dt, _clock.dt}, &neutral, _edges.get());
  _lost += _contact.lost();
  _penetration =
      maxOf(_penetration, maxOf(_contact.nodes.max_penetration, _contact.edges.max_penetration));
  if (!_enforcement->hasForces())
    return; // computeForces() left zeros
  sum_forces(_enforcement->forces());
  _coupling->storeContactForces(_space, _enforcement->forces(), _forces);
}

// All nodes but those of bricks that step by themselves and of bodies at rest.
const mechanics::NodeSelection& Simulation::movingNodes() const {
  return _resting.any() ? _resting.movingNodes() : _other_nodes;
}

void Simulation::kickVelocities(double dt_kick, double time_of_velocity) {
  {
    const Region region("step::kick");
    _resting.wake(_space, _forces);
    const mechanics::SpeedTest test = _guard.speedTest(_ledger.meanVelocity());
    _kick = mechanics::kick(_space, _scene.mesh, _boundary, time_of_velocity, dt_kick, _forces,
                            _state, _scales, test, movingNodes());
    // Against the mean even what rests may be fast.
    if (_resting.any() && !(dot(test.around, test.around) <= test.limit * test.limit))
      ++_kick.sum[mechanics::kick_fast_nodes].high;
  }
  if (_free_bricks.any())
    stepFreeBricks(dt_kick, time_of_velocity);
}

void Simulation::stepFreeBricks(double dt_kick, double time_of_velocity) {
  const Region region("step::free bricks");
  const auto sums =
      _free_bricks.step(_space, _scene.mesh, *_internal_force, _boundary, time_of_velocity,
                        !_free_have_drifted, _clock.dt_before, dt_kick, _state, _scales);
  _internal.energy += sums.internal.energy;
  _internal.failure += sums.internal.failure;
  _kick += sums.kick;
}

// Bricks that nothing but their own forces, gravity and prescribed motions moves.
void Simulation::freeBricks() {
  _other_nodes = mechanics::NodeSelection::allOf(_scene.mesh.num_nodes);
  if (_config.contact.enabled || _config.viscosity.any() || !host_accessible ||
      !_config.spare.free_bricks)
    return;
  std::vector<char> is_loaded(_scene.mesh.num_nodes, 0);
  for (const auto& load : _loads) {
    const auto faces = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), load.faceToNodes());
    for (std::size_t face = 0; face < faces.extent(0); ++face)
      for (int corner = 0; corner < 4; ++corner)
        is_loaded[faces(face, corner)] = 1;
  }
  _free_bricks = mechanics::FreeBricks(_space, _scene.mesh, *_internal_force, is_loaded);
  if (_free_bricks.any())
    _other_nodes = _free_bricks.otherNodes();
}

// Forces reach a body by its surface, and this rank's part of it by shared nodes. Without contact few bodies ever wake.
void Simulation::restBodies() {
  if (!_config.spare.resting_bodies || !_config.contact.enabled)
    return;
  std::vector<char> may_be_pushed(_scene.mesh.num_nodes, 0);
  const auto surface =
      Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), _scene.skin.surface_to_node);
  for (std::size_t s = 0; s < surface.extent(0); ++s)
    may_be_pushed[surface(s)] = 1;
  for (const auto& nodes : sharedNodes(_scene.part).nodes)
    for (const int node : nodes)
      may_be_pushed[node] = 1;
  _resting =
      mechanics::RestingBodies(_space, _scene.mesh, _state, prescribedMotions(_config, _scene.part),
                               _boundary.gravity(), may_be_pushed);
  _internal_force->leaveOutResting(_resting.flags());
}

void Simulation::allocateForces() {
  _forces.values = View<std::int64_t**>("state::forces", _scene.mesh.num_nodes,
                                        mechanics::numForceColumns(_config.viscosity.any()));
}

const mechanics::NodalForces& Simulation::forces() {
  if (!_has_all_forces) {
    if (_other_nodes.numRuns() == 0)
      allocateForces();
    _internal_force->addLeftOut(_space, _state.displacement, _forces);
    _has_all_forces = true;
  }
  return _forces;
}

void Simulation::bookEnergies(double dt_kick) {
  const Region region("step::ledger");
  _spared_element_steps += _resting_elems;
  mechanics::StepCounts counts;
  counts.failures = _load_failures + _contact.failures();
  counts.host[deeper_than_warned] = _penetration > _config.limits.warn[gauge_penetration];
  counts.host[deeper_than_allowed] = _penetration > _config.limits.stop[gauge_penetration];
  counts.host[deeper_than_boxes] =
      reachOf(maxOf(_contact.nodes.deepest, _contact.edges.deepest)) > _box_tolerance;
  _ledger.bookStep(_comm, dt_kick, _clock.dt, _internal, _contact_ledger.add(_contact), _kick,
                   counts);
  if (_ledger.balance().failures > 0) {
    const std::string failure = describeFailure();
    stepBack(dt_kick);
    throw PhysicsError(failure);
  }
}

// Undoes the kick and the drift that led to a failed element, so that the last good state can be written, with its
// forces; only those of contact stay as they are. Forces that failed were never added, so what was added is finite. The
// start has no drift and no step before it.
void Simulation::stepBack(double dt_kick) {
  undoKickAndDrift(_space, _scene.mesh, _boundary, dt_kick, _clock.dt_before, forces(), _state);
  _clock.time -= _clock.dt_before;
  _clock.step = maxOf<std::int64_t>(_clock.step - 1, 0);
  computeForces(_clock.time);
  sumSharedNodes();
  forces();
  if (_coupling)
    _coupling->storeContactForces(_space, _enforcement->forces(), _forces);
}

std::string Simulation::describeFailure() {
  std::ostringstream message;
  const auto failure = mechanics::agreeOnFailure(_space, _comm, _scene.mesh, _internal.failure);
  auto contact_sums = _contact;
  contact::sumOverRanks(_comm, contact_sums.nodes);
  contact::sumOverRanks(_comm, contact_sums.edges);
  message << "the computation broke down in step " << _clock.step << " (time " << _clock.time
          << "): ";
  if (failure.count > 0)
    message << mechanics::describe(failure);
  else if (contact_sums.failures() > 0)
    message
        << (contact_sums.nodes.failures() > 0 ? contact_sums.nodes : contact_sums.edges).problem();
  else
    message << "a load or an energy is not finite or beyond the range of the exact sums";
  return message.str();
}

Simulation::Simulation(MPI_Comm comm, const Config& config, const Scene& scene)
    : _comm(comm), _config(config), _scene(scene),
      _boundary(_space, scene.mesh.num_nodes, prescribedMotions(config, scene.part),
                toVec3(config.gravity), config.mass_damping),
      _shared(scene.shared) {
  const auto& mesh = scene.mesh;
  _state.mass = scene.mass;
  _state.displacement = View<double* [3]>("state::displacement", mesh.num_nodes);
  _state.velocity = View<double* [3]>("state::velocity", mesh.num_nodes);
  _forces.quantum = Quantum::forForceScale(mechanics::forceScale(_space, comm, mesh));
  allocateForces();
  _scales = mechanics::ledgerScales(_space, comm, mesh);
  const auto kind = config.formulation == Formulation::tlps ? mechanics::ElementKind::one_point
                                                            : mechanics::ElementKind::full;
  _internal_force = std::make_unique<mechanics::InternalForce>(
      _space, comm, mesh, kind, _forces.quantum, _scales.energy, 0, config.spare.lattices);
  _loads = pressureLoads(_space, config, scene);
  freeBricks();
  for (const MaterialConfig& material : config.materials)
    _is_objective = _is_objective && material.material.model != mechanics::MaterialModel::linear;
  setInitialDeformations(_space, config, scene, _shared, _state);
  setInitialVelocities(_space, config, scene, _shared, _boundary, _state);
  restBodies();

  setStepLimits();
  planSteps(longestStepAtStart());
  if (config.mass_damping * _clock.dt >= 2)
    throw InputError(reversingDamping(config.mass_damping, _clock.dt));
  if (config.contact.enabled)
    setUpContact();
  _ledger = mechanics::EnergyLedger(comm, _scales, _boundary.gravity(),
                                    mechanics::totalMass(_space, comm, mesh, scene.mass),
                                    mechanics::motionOf(_space, mesh, _state, _scales));
}

void Simulation::setUpContact() {
  _coupling = std::make_unique<SurfaceCoupling>(_space, _scene, _boundary);
  _drops_same_body = _config.contact.self == SelfContact::never ||
                     (_config.contact.self == SelfContact::automatic && _config.wall.has_value());
  _box_tolerance = _reach =
      boxTolerance(_config.contact, _scene.shortest_edge, _scene.longest_edge);
  const contact::SearchConfig search = searchConfig(_config, _box_tolerance, _drops_same_body);
  const double margin = _config.search.margin * _scene.shortest_edge;
  _search = std::make_unique<contact::CandidateSearch>(_comm, search, margin);
  contact::EnforcementConfig enforcement;
  enforcement.scheme = _config.contact.scheme == ContactScheme::energy_neutral
                           ? contact::Scheme::energy_neutral
                           : contact::Scheme::penalty;
  enforcement.penalty = _config.contact.penalty;
  enforcement.leaves_out_still = _config.spare.still_contact;
  enforcement.reference_step = _clock.dt;
  enforcement.lateral_tolerance = _config.contact.lateral_tolerance;
  enforcement.edge_tolerance = _config.contact.edge_tolerance;
  enforcement.friction = _config.contact.friction;
  enforcement.friction_stiffness = _config.contact.friction_stiffness;
  enforcement.damping = _config.contact.damping;
  enforcement.self_contact = !_drops_same_body;
  enforcement.least_depth = 1e-12 * _scene.shortest_edge;
  enforcement.deepest_birth = deepestBirth(_config.contact, _scene.shortest_edge);
  _guard = TunnellingGuard(_config, search.node_tolerance + search.face_tolerance, _clock.dt);
  _coupling->resetCoordinates(_space, _state.displacement);
  refuseDeepOverlaps(_space, _comm, _config, _scene, _coupling->surface(), _state.displacement);
  const contact::FeatureEdges features = contact::findFeatureEdges(_comm, _coupling->surface());
  _coupling->setTrueEdges(_space, features.true_edges);
  _enforcement = std::make_unique<contact::Enforcement>(_space, _comm, _coupling->surface(),
                                                        _coupling->nodeMass(), enforcement,
                                                        _forces.quantum, _scales.energy);
  if (!_config.contact.edges)
    return;
  _edges = std::make_unique<contact::EdgeContact>(_space, _comm, _coupling->surface(), features,
                                                  _coupling->nodeMass(), search, margin,
                                                  enforcement, _forces.quantum, _scales.energy);
  if (allReduce(_comm, _edges->numEdges(), MPI_SUM) == 0)
    _edges.reset(); // nothing but smooth bodies
}

ContactCounts Simulation::contactCounts() const {
  ContactCounts counts;
  if (!_coupling)
    return counts;
  std::int64_t sums[4] = {_search->ghosts().count, _search->pairs().count, _contact.active(),
                          _lost};
  allReduce(_comm, sums, 4, MPI_SUM);
  counts.searches = _search->searches();
  counts.updates = _search->updates();
  counts.ghost_faces = sums[0];
  counts.candidate_pairs = sums[1];
  counts.active = sums[2];
  counts.lost = sums[3];
  counts.missed_pairs = _missed_pairs;
  counts.largest_penetration = allReduce(_comm, _penetration, MPI_MAX);
  counts.max_penetration = allReduce(
      _comm, maxOf(_contact.nodes.max_penetration, _contact.edges.max_penetration), MPI_MAX);
  return counts;
}

GaugeValues Simulation::gauges() {
  const mechanics::EnergyBalance& b = _ledger.balance();
  const LimitsConfig& limits = _config.limits;
  const bool is_deep = (b.host_counts[deeper_than_warned] > 0 &&
                        _known_penetration <= limits.warn[gauge_penetration]) ||
                       (b.host_counts[deeper_than_allowed] > 0 &&
                        _known_penetration <= limits.stop[gauge_penetration]);
  if (is_deep)
    _known_penetration = allReduce(_comm, _penetration, MPI_MAX);
  GaugeValues values;
  values[gauge_energy] = b.energy_error;
  values[gauge_momentum] = b.momentum_error;
  values[gauge_angular_momentum] = _is_objective ? b.angular_momentum_error : 0;
  values[gauge_contact] = b.contact_error;
  values[gauge_hourglass] = b.hourglassShare();
  values[gauge_penetration] = _known_penetration;
  return values;
}

std::int64_t Simulation::numRestingElems() const {
  return allReduce(_comm, _resting.numElems(), MPI_SUM);
}
std::int64_t Simulation::sparedElementSteps() const {
  return allReduce(_comm, _spared_element_steps, MPI_SUM);
}
std::int64_t Simulation::numFreeElems() const {
  return allReduce(_comm, _free_bricks.numElems(), MPI_SUM);
}

std::int64_t Simulation::numLatticeElems() const {
  std::int64_t count = 0;
  for (const auto& lattice : _internal_force->lattices().on_host)
    count += lattice.numElems();
  return allReduce(_comm, _config.viscosity.any() ? 0 : count, MPI_SUM);
}
std::int64_t Simulation::numCongruentElems() const {
  return allReduce(_comm, _internal_force->numCongruentElems(), MPI_SUM);
}

} // namespace brickwall::miniapp
