// Prints the speed of contact enforcement, without search and solver, in candidate pairs per
// second, rejected pairs included. The scene is a wall of rigid bricks of 16x8x8 elements in
// running bond that are pressed together, stand flush, or fly apart. Bodies in contact move at
// constant speed: other forces balance those of the contacts, as the elements' forces do; or
// nothing balances them, so that the energy-neutral scheme takes each step for the last one of
// every contact and corrects all forces in every round. BRICKWALL_COURSES is the number of courses,
// each of about half as many bricks (29 courses are W(8)). The flops and bytes of a contact are
// counted: of a persistent contact of a node with a face, whose force is corrected once.
#include "contact/enforcement/edge_edge/edge_contact.hpp"
#include "contact/enforcement/law/contact_law.hpp"
#include "contact/enforcement/law/correct_springs.hpp"
#include "contact/enforcement/law/persistent_contact.hpp"
#include "contact/enforcement/node_face/node_faces.hpp"
#include "contact/search/candidate_search.hpp"
#include "tests/contact/enforcement/support/brick_scene.hpp"
#include "verification/performance/benchmarks/benchmark_clock.hpp"
#include "verification/performance/benchmarks/benchmark_main.hpp"
#include "verification/performance/benchmarks/counted.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace brickwall::contact {
namespace {

constexpr double edge_length = 0.125, dt = 0.05;

int numCourses() {
  const char* text = std::getenv("BRICKWALL_COURSES");
  return text ? std::atoi(text) : 6;
}

template <class ViewType, class Set>
ViewType filled(const std::string& label, std::size_t n, const Set& set) {
  ViewType view(label, n);
  const auto host = Kokkos::create_mirror_view(view);
  for (std::size_t i = 0; i < n; ++i)
    set(host, i);
  Kokkos::deep_copy(view, host);
  return view;
}

// The skin of a wall whose bricks move towards its middle.
class Wall {
public:
  explicit Wall(int courses) : _courses(courses) {
    testing::Scene scene;
    for (int course = 0; course < courses; ++course)
      for (int along = 0; along < (courses + 1) / 2; ++along) {
        _place.push_back({2.0 * along + (course % 2), 0, 1.0 * course});
        scene.addBox(_place.back(), {2, 1, 1}, {16, 8, 8});
      }
    std::vector<int> number(scene.x_new.size(), -1);
    for (const auto& face : scene.faces)
      for (const int node : face.nodes)
        number[node] = 0;
    for (std::size_t node = 0; node < number.size(); ++node)
      if (number[node] == 0) {
        number[node] = static_cast<int>(_nodes.size());
        _nodes.push_back(static_cast<int>(node));
        _x.push_back(scene.x_new[node]);
        _body.push_back(scene.node_body[node]);
      }
    const std::size_t num_nodes = _nodes.size(), num_faces = scene.faces.size();
    _surface.num_nodes = static_cast<int>(num_nodes);
    _surface.num_faces = static_cast<int>(num_faces);
    _surface.face_to_nodes =
        filled<View<int* [4]>>("face_to_nodes", num_faces, [&](auto& v, std::size_t f) {
          for (int j = 0; j < 4; ++j)
            v(f, j) = number[scene.faces[f].nodes[j]];
        });
    _surface.face_ids = filled<View<global_id*>>(
        "face_ids", num_faces, [&](auto& v, std::size_t f) { v(f) = scene.faces[f].id; });
    _surface.face_body = filled<View<global_id*>>(
        "face_body", num_faces, [&](auto& v, std::size_t f) { v(f) = scene.faces[f].body; });
    _surface.node_ids = filled<View<global_id*>>("node_ids", num_nodes,
                                                 [&](auto& v, std::size_t i) { v(i) = _nodes[i]; });
    _surface.node_body = filled<View<global_id*>>("node_body", num_nodes,
                                                  [&](auto& v, std::size_t i) { v(i) = _body[i]; });
    _surface.node_is_owned = filled<View<unsigned char*>>(
        "node_is_owned", num_nodes, [&](auto& v, std::size_t i) { v(i) = 1; });
    _mass = filled<View<double*>>("mass", num_nodes,
                                  [&](auto& v, std::size_t i) { v(i) = scene.mass[_nodes[i]]; });
    const AttributeWords attributes("attributes", num_faces, words_of<FaceAttributes>);
    const auto host = Kokkos::create_mirror_view(attributes);
    for (std::size_t f = 0; f < num_faces; ++f) {
      FaceAttributes& values = attributesAt<FaceAttributes>(host, f);
      for (int j = 0; j < 4; ++j)
        values.corner_mass[j] = scene.mass[scene.faces[f].nodes[j]];
      values.surface_mass = scene.faces[f].surface_mass;
    }
    Kokkos::deep_copy(attributes, host);
    _surface.face_attributes = attributes;
    _old = View<double* [3]>("x_old", num_nodes);
    _new = View<double* [3]>("x_new", num_nodes);
    _surface.coordinates_old = _old;
    _surface.coordinates_new = _new;
    contract(0);
    contract(0);
    const FeatureEdges features = findFeatureEdges(MPI_COMM_SELF, _surface);
    for (std::size_t f = 0; f < num_faces; ++f)
      attributesAt<FaceAttributes>(host, f).feature_edges = features.face_edges[f];
    Kokkos::deep_copy(attributes, host);
    edges = features;
  }

  // Advances x^n to x^{n+1}, then moves every brick from its first place by this share of its
  // distance to the middle.
  void contract(double share) {
    std::swap(_old, _new);
    _surface.coordinates_old = _old;
    _surface.coordinates_new = _new;
    const auto host = Kokkos::create_mirror_view(_new);
    for (std::size_t i = 0; i < _x.size(); ++i)
      for (int d = 0; d < 3; ++d)
        host(i, d) = _x[i][d] + share * (0.5 * _courses - _place[_body[i]][d]) * (d != 1);
    Kokkos::deep_copy(_new, host);
  }
  const Surface& surface() const { return _surface; }
  const View<const double*> mass() const { return _mass; }
  std::size_t numBricks() const { return _place.size(); }

  FeatureEdges edges;

private:
  int _courses;
  std::vector<Vec3> _place, _x;
  std::vector<int> _nodes, _body;
  Surface _surface;
  View<double*> _mass;
  View<double*[3]> _old, _new;
};

// Accelerations that balance the contact forces.
void balance(const exec_space& space, const ContactForces& forces, const Quantum& quantum,
             const View<const double*>& mass, const View<double* [3]>& accelerations) {
  const auto nodes = forces.nodes;
  Kokkos::parallel_for(
      "balance", rangePolicy(space, mass.extent(0)), KOKKOS_LAMBDA(const std::int64_t i) {
        for (int d = 0; d < 3; ++d)
          accelerations(i, d) = -static_cast<double>(nodes(i, d)) * quantum.value / mass(i);
      });
}

void printSpeed(const char* name, double share_a_step, bool is_balanced = true) {
  const exec_space space;
  Wall wall(numCourses());
  SearchConfig search_config;
  search_config.node_tolerance = search_config.face_tolerance = 0.05 * edge_length;
  search_config.drop_same_body = true;
  EnforcementConfig config;
  config.reference_step = dt;
  config.edge_tolerance = 0.2;
  config.least_depth = 1e-12 * edge_length;
  const Quantum quantum = Quantum::forForceScale(1);
  const LimbScale scale = LimbScale::forLargest(1e3);
  CandidateSearch search(MPI_COMM_SELF, search_config);
  EdgeContact edges(space, MPI_COMM_SELF, wall.surface(), wall.edges, wall.mass(), search_config, 0,
                    config, quantum, scale);
  Enforcement enforcement(space, MPI_COMM_SELF, wall.surface(), wall.mass(), config, quantum,
                          scale);
  const View<double* [3]> by_others("accelerations", wall.surface().num_nodes);
  NeutralInput neutral;
  neutral.accelerations = [&](const NodeList&) { return by_others; };
  neutral.sum_forces = [](const ContactForces&) {};
  neutral.share_with_ghosts = [](const View<const double* [3]>&, const View<double* [12]>&) {};
  std::vector<double> seconds;
  std::int64_t active = 0, node_pairs = 0, edge_pairs = 0;
  constexpr int steps = 12, warm_up = 3;
  for (int step = 0; step < steps; ++step) {
    wall.contract((step + 1) * share_a_step);
    search.update(space, wall.surface());
    edges.findCandidates(space, wall.surface());
    space.fence();
    const double begin = now();
    active =
        enforcement
            .enforce(space, wall.surface(), search.ghosts(), search.pairs(), dt, &neutral, &edges)
            .active();
    space.fence();
    if (step >= warm_up)
      seconds.push_back(now() - begin);
    if (is_balanced)
      balance(space, enforcement.forces(), quantum, wall.mass(), by_others);
    node_pairs = search.pairs().count;
    edge_pairs = edges.search().pairs().count;
  }
  std::sort(seconds.begin(), seconds.end());
  const double median = seconds[seconds.size() / 2], least = seconds[0];
  const auto pairs = static_cast<double>(node_pairs + edge_pairs);
  std::printf(
      "%-13s %zu bricks, %d faces, %lld + %lld pairs (nodes + edges), %lld active: %.2f ms a step "
      "(least %.2f), %.1f M pairs/s, %.1f ns a pair, %d threads\n",
      name, wall.numBricks(), wall.surface().num_faces, static_cast<long long>(node_pairs),
      static_cast<long long>(edge_pairs), static_cast<long long>(active), 1e3 * median, 1e3 * least,
      1e-6 * pairs / median, 1e9 * median / pairs, concurrency(space));
}

// A node above the middle of a unit face, which has penetrated it: projection, contact law, forces
// in quanta and their correction, as the lanes compute them.
std::int64_t flopsOfContact() {
  constexpr double depth = 1e-3;
  const Vec3 corner[4] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  persistent_contact::Gathered<Counted> gathered;
  correct_springs::Gathered<Counted> springs;
  for (int j = 0; j < 4; ++j) {
    gathered.corner[j].set(0, corner[j]);
    gathered.corner_motion[j].set(0, Vec3());
    gathered.corner_mass[j][0] = 1;
    gathered.last_weight[j][0] = springs.weight[j][0] = 0.25;
    springs.corner_acceleration[j].set(0, Vec3());
  }
  gathered.node.set(0, {0.4, 0.4, -depth});
  gathered.node_motion.set(0, {0, 0, -depth / 4});
  gathered.node_mass[0] = 1;
  PairForces add;
  CorrectPair correct{{{}, GhostFaces::none()}, {}, {}, dt, dt, 0, 0};
  ContactLaw law;
  law.dt = law.previous_dt = dt;
  Counted::count = 0;
  persistent_contact::Found<Counted> found;
  persistent_contact::evaluate(gathered, found);
  ContactState<Counted> state;
  state.normal = found.normal;
  state.motion = found.motion;
  state.penetration[0] = -found.gap[0];
  state.inverse_mass = found.inverse_mass;
  state.is_persistent[0] = state.last_stiffness[0] = state.last_fade_weight[0] = 1;
  state.last_depth[0] = 0.75 * depth;
  state.was_new[0] = state.has_changed_face[0] = state.last_offset[0] = state.last_stored[0] = 0;
  state.contact_work[0] = state.closing_at_last_point[0] = state.activation_stiffness[0] = 0;
  law.setSpring(state, Counted(2));
  state.spring_energy = ContactLaw::springEnergy(state);
  law.followEnergy(state);
  PairQuanta<Counted> quanta;
  const Counted weights[4] = {found.weight[0], found.weight[1], found.weight[2], found.weight[3]};
  add.round(Counted(state.first_force), Triple<Counted>(state.normal), Counted(0), weights, quanta);
  springs.force = springs.first_force = state.first_force;
  springs.damping[0] = springs.first_damping[0] = springs.is_new[0] = springs.response[0] = 0;
  springs.depth = state.depth;
  springs.offset = state.offset;
  springs.stored = state.stored;
  springs.closing = state.closing;
  springs.inverse_mass = state.inverse_mass;
  springs.normal = state.normal;
  springs.acceleration.set(0, Vec3());
  correct_springs::Corrected<Counted> corrected;
  correct_springs::evaluate(springs, correct, add, corrected); // the proposal
  correct.responses.nodes = View<double* [3]>("responses", 1);
  correct_springs::evaluate(springs, correct, add, corrected);
  return Counted::count;
}

// What a contact reads and writes, as if no two contacts had a node or a face in common.
std::size_t bytesOfContact() {
  constexpr std::size_t vector = sizeof(Vec3), id = sizeof(global_id), candidates = 4, nodes = 5;
  const std::size_t selection = sizeof(Interaction) + 2 * nodes * vector + nodes * sizeof(double) +
                                candidates * (sizeof(int) + sizeof(FaceRecord)) + 4 * sizeof(int) +
                                3 * id;
  const std::size_t written = sizeof(Interaction) + 2 * nodes * vector; // forces: read and written
  const std::size_t correction = 2 * sizeof(Interaction) + nodes * vector;
  return selection + written + correction;
}

} // namespace
} // namespace brickwall::contact

int main(int argc, char** argv) {
  return brickwall::benchmarkMain(argc, argv, [] {
    using brickwall::contact::printSpeed;
    printSpeed("full contact", 2e-4);
    printSpeed("all corrected", 2e-4, false);
    printSpeed("at rest", 0);
    printSpeed("flying apart", -2e-4);
    std::printf("contact: %lld flops, %zu B\n",
                static_cast<long long>(brickwall::contact::flopsOfContact()),
                brickwall::contact::bytesOfContact());
  });
}
