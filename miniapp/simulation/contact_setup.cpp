// Contact of a simulation before its first step: surface, search, enforcement, guard, edges.
#include "contact/base/mpi.hpp"
#include "miniapp/deck/search_choice.hpp"
#include "miniapp/scene/initial_overlaps.hpp"
#include "miniapp/simulation/simulation.hpp"

namespace brickwall::miniapp {

namespace {

// Of the shortest element edge. Lists of edges are kept even where those of nodes are made anew in each step: contacts do not depend
// on it, and few of the pairs come near each other.
constexpr double edge_margin = 0.2;

contact::EnforcementConfig enforcementConfig(const Config& config, double shortest_edge,
                                             double reference_step, bool drops_same_body) {
  const ContactConfig& deck = config.contact;
  contact::EnforcementConfig enforcement;
  enforcement.scheme = deck.scheme == ContactScheme::energy_neutral
                           ? contact::Scheme::energy_neutral
                           : contact::Scheme::penalty;
  enforcement.penalty = deck.penalty;
  enforcement.skip_stationary = config.spare.still_contact;
  enforcement.reference_step = reference_step;
  enforcement.lateral_tolerance = deck.lateral_tolerance;
  enforcement.edge_tolerance = deck.edge_tolerance;
  enforcement.friction = deck.friction;
  enforcement.friction_stiffness = deck.friction_stiffness;
  enforcement.damping = deck.damping;
  enforcement.self_contact = !drops_same_body;
  enforcement.least_depth = 1e-12 * shortest_edge;
  enforcement.deepest_birth = deepestBirth(deck, shortest_edge);
  return enforcement;
}

} // namespace

void Simulation::setUpContact() {
  _coupling = std::make_unique<SurfaceCoupling>(_space, _scene, _boundary);
  _drops_same_body = _config.contact.self == SelfContact::never ||
                     (_config.contact.self == SelfContact::automatic && _config.wall.has_value());
  _box_tolerance = _reach =
      boxTolerance(_config.contact, _scene.shortest_edge, _scene.longest_edge);
  const contact::SearchConfig search = searchConfig(_config, _box_tolerance, _drops_same_body);
  const double margin = _config.search.margin * _scene.shortest_edge;
  _search = std::make_unique<contact::CandidateSearch>(_comm, search, margin);
  const contact::EnforcementConfig enforcement =
      enforcementConfig(_config, _scene.shortest_edge, _clock.dt, _drops_same_body);
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
                                                  _coupling->nodeMass(), search,
                                                  maxOf(margin, edge_margin * _scene.shortest_edge),
                                                  enforcement, _forces.quantum, _scales.energy);
  if (allReduce(_comm, _edges->numEdges(), MPI_SUM) == 0)
    _edges.reset(); // nothing but smooth bodies
}

} // namespace brickwall::miniapp
