#include "miniapp/simulation/contact_step.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "contact/enforcement/law/edge_fading.hpp"
#include "miniapp/scene/initial_overlaps.hpp"
#include "miniapp/timing/stopwatch.hpp"

namespace brickwall::miniapp {

namespace {

// Relative to the shortest element edge. Lists of edges are kept even if those of nodes are rebuilt
// in each step: contact does not depend on the margin, and few of the additional pairs come near
// each other.
constexpr double edge_margin = 0.2;

contact::EnforcementConfig enforcementConfig(const Config& config, double shortest_edge,
                                             double reference_step) {
  const ContactConfig& deck = config.contact;
  contact::EnforcementConfig enforcement = deck;
  enforcement.skip_stationary = config.skip.stationary_contact;
  enforcement.reference_step = reference_step;
  enforcement.self_contact = !dropsSameBody(config);
  enforcement.least_depth = 1e-12 * shortest_edge;
  enforcement.max_activation_depth = deepestActivation(deck, shortest_edge);
  return enforcement;
}

// Low and high corners of boxes [node][low xyz, high xyz].
void splitBoxes(const exec_space& space, const View<const double* [6]>& boxes,
                const View<double* [3]>& low, const View<double* [3]>& high) {
  Kokkos::parallel_for(
      "miniapp::ContactStep::splitBoxes",
      rangePolicy(space, static_cast<std::int64_t>(boxes.extent(0))),
      KOKKOS_LAMBDA(const std::int64_t i) {
        for (int d = 0; d < 3; ++d) {
          low(i, d) = boxes(i, d);
          high(i, d) = boxes(i, 3 + d);
        }
      });
}

double deepest(const contact::EnforcementSums& sums) {
  return maxOf(sums.nodes.deepest, sums.edges.deepest);
}

} // namespace

ContactStep::ContactStep(const exec_space& space, MPI_Comm comm, const Config& config,
                         const Scene& scene, const mechanics::BoundaryConditions& boundary,
                         const View<const double* [3]>& displacement, double dt,
                         const Quantum& force_quantum, const LimbScale& energy_scale)
    : _comm(comm), _config(config), _scene(scene), _space(space), _dt(dt),
      _force_quantum(force_quantum), _energy_scale(energy_scale),
      _box_tolerance(boxTolerance(config.contact, scene.shortest_edge, scene.longest_edge)),
      _search_tolerance(_box_tolerance), _coupling(space, comm, scene, boundary),
      _search(comm, searchConfig(config, _box_tolerance, dropsSameBody(config)),
              config.search.margin * scene.shortest_edge),
      _guard(config, 2 * _box_tolerance, dt), _balance(comm, 0) {
  _coupling.resetCoordinates(space, displacement);
  refuseDeepOverlaps(space, comm, config, scene, surface(), displacement);
  _coupling.setFeatureEdges(space, contact::findFeatureEdges(comm, surface()));
  distributeAtStart(displacement);
  const Stopwatch time;
  makeEnforcement();
  const bool may_stay = config.search.decomposition == Decomposition::automatic;
  // A distribution repeats this, moves faces and history, and searches: 3.5 to 4 times as long.
  _balance =
      ContactBalance(comm, 4 * time.seconds(), may_stay ? ContactBalance::usual_overhead : 1);
  if (config.output.has(OutputField::slip_distance)) {
    _slip = View<double*>("miniapp::ContactStep::slip", surface().num_nodes);
    _slip_sum = scene.shared;
  }
}

void ContactStep::makeEnforcement() {
  const contact::EnforcementConfig enforcement =
      enforcementConfig(_config, _scene.shortest_edge, _dt);
  _enforcement = std::make_unique<contact::Enforcement>(
      _space, _comm, surface(), _coupling.nodeMass(), enforcement, _force_quantum, _energy_scale);
  if (!_config.contact.edges)
    return;
  _edges = std::make_unique<contact::EdgeContact>(
      _space, _comm, surface(), _coupling.featureEdges(), _coupling.nodeMass(),
      searchConfig(_config, _box_tolerance, dropsSameBody(_config)),
      maxOf(_search.margin(), edge_margin * _scene.shortest_edge), enforcement, _force_quantum,
      _energy_scale);
  if (allReduce(_comm, _edges->numEdges(), MPI_SUM) == 0)
    _edges.reset(); // all bodies are smooth
}

// A node that is pressed in deeply must keep its faces. Boxes of node and face together reach as
// far as the deepest loaded contact may fade out beyond an edge: fade_depth_ratio times its depth,
// with a margin, but no farther than three quarters of the longest edge (half of it for fading) or
// the shortest one.
double ContactStep::toleranceFor(double deepest) const {
  constexpr double fade_depth_ratio = contact::FadeRegion::fade_depth_ratio;
  const double longest = _scene.longest_edge;
  const double reach =
      (fade_depth_ratio + 0.2) * deepest + 0.1 * _config.contact.edge_tolerance * longest;
  return deepest > 0 ? 0.5 * minOf(reach, maxOf(_scene.shortest_edge, 0.75 * longest)) : 0;
}

// The tolerance grows with a reserve and shrinks late, because each change discards the lists of
// candidates.
void ContactStep::growSearchTolerance(const contact::EnforcementSums& sums) {
  const double needed = toleranceFor(allReduce(_comm, deepest(sums), MPI_MAX));
  if (needed > _search_tolerance)
    setSearchTolerance(1.25 * needed);
  else if (needed < 0.5 * _search_tolerance)
    setSearchTolerance(maxOf(_box_tolerance, needed));
}

void ContactStep::setSearchTolerance(double tolerance) {
  _search_tolerance = tolerance;
  _search.setTolerances(_search_tolerance, _search_tolerance);
  if (_edges)
    _edges->setTolerance(_search_tolerance);
}

void ContactStep::findCandidates(bool are_final, const std::function<void()>& meanwhile) {
  _has_forces_of_search = false;
  const Stopwatch time;
  if (are_final && !host_accessible && _search.margin() == 0) {
    bool is_measured = false;
    const auto measure_and_more = [&] {
      _has_moved.waitIn(_beside);
      measureSurface(_beside, true);
      is_measured = true;
      if (meanwhile)
        meanwhile();
    };
    _search.update(_space, surface(), {}, measure_and_more);
    if (!is_measured)
      measure_and_more();
    _beside.fence(); // the host reads the measures
  } else {
    const auto stationary = measureSurface(_space, are_final);
    _search.update(_space, surface(), {}, meanwhile, stationary);
  }
  if (_edges)
    _edges->findCandidates(_space);
  _balance.addTime(time.seconds());
}

View<const unsigned char*> ContactStep::measureSurface(const exec_space& space, bool is_final) {
  View<const unsigned char*> stationary;
  if (is_final) // the host reads the motion after its waits for the search
    stationary = _enforcement->startMotion(space, surface());
  if (_edges)
    _edges->gatherCoordinates(space, surface(), stationary);
  return stationary;
}

void ContactStep::auditCandidates() {
  _missed_pairs += _search.countMissedPairs(_space, surface());
  if (_edges)
    _missed_pairs += _edges->countMissedPairs(_space);
}

contact::PairMotion ContactStep::fastestPair(const Vec3& mean, double limit) {
  contact::PairMotion fastest =
      _fastest_pair.find(_space, _comm, surface(), _search.ghosts(), _search.pairs(), mean, limit);
  if (_edges) {
    const auto fastest_edges = _edges->fastestPair(_space, _comm, mean, limit);
    if (fastest_edges.motion > fastest.motion)
      fastest = fastest_edges;
  }
  return fastest;
}

double ContactStep::shortenForPair(const contact::PairMotion& pair, double dt, const Clock& clock) {
  const double longest = _guard.shorten(dt, pair, !hasForces(), clock.step, clock.time,
                                        EntityNames(_comm, _scene.part));
  _enforcement->setReferenceStep(_guard.referenceStep());
  if (_edges)
    _edges->setReferenceStep(_guard.referenceStep());
  return longest;
}

contact::EnforcementSums ContactStep::enforce(const contact::StepLengths& steps,
                                              const mechanics::NodalForces& forces,
                                              const mechanics::NodalState& state,
                                              const mechanics::BoundaryConditions& boundary,
                                              mechanics::SharedNodeSum& shared) {
  const Stopwatch time;
  const contact::Surface surface = _coupling.surface();
  const auto sum_forces = [&](const contact::ContactForces& contact_forces) {
    shared.finish(_space);
    _coupling.sumContactForces(_space, contact_forces, _search);
  };
  contact::NeutralInput neutral;
  neutral.list_shared = [&](const contact::GhostsInUse& ghosts, contact::TouchedNodes& list) {
    _coupling.shareListed(_space, _search, ghosts, list);
  };
  if (_config.contact.scheme == contact::Scheme::energy_neutral) {
    neutral.accelerations = [&](const contact::NodeList& nodes) {
      shared.finish(_space);
      return _coupling.accelerations(_space, nodes, forces, state, 0.5 * (steps.dt + steps.next_dt),
                                     boundary);
    };
    neutral.sum_forces = sum_forces;
    neutral.completes_sums = true;
    neutral.share_with_ghosts = [&](const View<const double* [3]>& values,
                                    const View<double* [12]>& ghost_values) {
      _coupling.shareWithGhosts(_space, _search, values, ghost_values);
    };
  }
  const contact::EnforcementSums sums = _enforcement->enforce(
      _space, surface, _search.ghosts(), _search.pairs(), steps, &neutral, _edges.get());
  _lost += sums.lost();
  _penetration = maxOf(_penetration, sums.maxPenetration());
  if (hasForces() && !_enforcement->hasTotals())
    sum_forces(_enforcement->forces());
  shared.finish(_space);
  storeForces(forces);
  _has_forces_of_search = true;
  _balance.addTime(time.seconds());
  return sums;
}

void ContactStep::countDeepContacts(const contact::EnforcementSums& sums,
                                    mechanics::StepCounts& counts) const {
  counts.host[deeper_than_warned] = _penetration > _config.limits.warn[gauge_penetration];
  counts.host[deeper_than_allowed] = _penetration > _config.limits.stop[gauge_penetration];
  counts.host[deeper_than_boxes] = toleranceFor(deepest(sums)) > _box_tolerance;
}

contact::LargestForce ContactStep::largestForce() const {
  contact::LargestForce largest =
      contact::largestForce(_space, _comm, surface(), _enforcement->history());
  if (_edges) {
    const contact::LargestForce of_edges = _edges->largestForce(_space, _comm);
    if (of_edges.force > largest.force)
      largest = of_edges;
  }
  return largest;
}

ContactRestart ContactStep::restartData(const contact::EnforcementSums& sums) const {
  ContactRestart data;
  data.search_tolerance = _search_tolerance;
  data.reference_step = _guard.referenceStep();
  double largest[3] = {sums.nodes.deepest, sums.edges.deepest, _penetration};
  allReduce(_comm, largest, 3, MPI_MAX);
  data.deepest[0] = largest[0];
  data.deepest[1] = largest[1];
  data.penetration = largest[2];
  data.known_penetration = _known_penetration;
  data.lost = allReduce(_comm, _lost, MPI_SUM);
  data.missed_pairs = _missed_pairs;
  data.searches = _search.searches();
  data.updates = _search.updates();
  data.ledger = _ledger.totals();
  allReduce(_comm, &data.ledger[0].high, 3 * static_cast<int>(data.ledger.size()), MPI_SUM);
  contact::ContactCarry nodes = _enforcement->carry(_space, surface());
  data.previous_dt = nodes.previous_dt;
  data.has_forces = nodes.has_forces;
  data.nodes = std::move(nodes.records);
  data.joints = std::move(nodes.joints);
  if (_edges) {
    contact::ContactCarry edges = _edges->carry(_space);
    data.edges_have_forces = edges.has_forces;
    data.edges = std::move(edges.records);
  }
  const auto boxes = toHost(_search.sweptBoxes());
  if (boxes.extent(0) > 0)
    for (int node = 0; node < surface().num_nodes; ++node)
      for (int i = 0; i < 6; ++i)
        data.swept_boxes.push_back(boxes(node, i));
  return data;
}

void ContactStep::restore(const ContactRestart& data, const View<const double* [3]>& displacement,
                          contact::EnforcementSums& sums) {
  const bool takes_sums = rankOf(_comm) == 0;
  setSearchTolerance(data.search_tolerance);
  _guard.setReferenceStep(data.reference_step);
  _enforcement->setReferenceStep(data.reference_step);
  sums.nodes.deepest = data.deepest[0];
  sums.edges.deepest = data.deepest[1];
  _penetration = data.penetration;
  _known_penetration = data.known_penetration;
  _lost = takes_sums ? data.lost : 0;
  _missed_pairs = data.missed_pairs;
  _ledger.restore(takes_sums ? data.ledger : std::array<LimbSum, 3>());
  _coupling.resetCoordinates(_space, displacement);
  _enforcement->restore(_space, surface(),
                        {data.nodes, data.previous_dt, data.has_forces, data.joints});
  if (_edges) {
    _edges->setReferenceStep(data.reference_step);
    _edges->restore(_space, {data.edges, data.previous_dt, data.edges_have_forces, {}});
  }
  searchIn(toDevice<View<double* [6]>>(_space, "miniapp::ContactStep::boxes", data.swept_boxes),
           data.searches, data.updates);
}

void ContactStep::searchIn(const View<const double* [6]>& boxes, std::int64_t searches,
                           std::int64_t updates) {
  contact::Surface swept = surface();
  const auto num_nodes = static_cast<std::int64_t>(boxes.extent(0));
  const auto low = allocate<View<double* [3]>>(_space, "miniapp::ContactStep::low", num_nodes);
  const auto high = allocate<View<double* [3]>>(_space, "miniapp::ContactStep::high", num_nodes);
  splitBoxes(_space, boxes, low, high);
  swept.coordinates_old = low;
  swept.coordinates_new = high;
  _search.restore(_space, swept, searches, updates);
}

double ContactStep::agreeOnPenetration(const std::int64_t* host_counts) {
  const LimitsConfig& limits = _config.limits;
  const bool exceeds_new_limit = (host_counts[deeper_than_warned] > 0 &&
                                  _known_penetration <= limits.warn[gauge_penetration]) ||
                                 (host_counts[deeper_than_allowed] > 0 &&
                                  _known_penetration <= limits.stop[gauge_penetration]);
  if (exceeds_new_limit)
    _known_penetration = allReduce(_comm, _penetration, MPI_MAX);
  return _known_penetration;
}

} // namespace brickwall::miniapp
