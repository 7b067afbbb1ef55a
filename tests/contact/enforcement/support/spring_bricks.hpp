// Time loop of contact tests: bricks of springs (between any two corners of a hexahedron), leapfrog
// integration, contact by the code under test, and the half-step energy. One rank.
#pragma once

#include "contact/enforcement/edge_edge/edge_contact.hpp"
#include "tests/contact/enforcement/support/brick_scene.hpp"

namespace brickwall::contact::testing {

class SpringBricks {
public:
  // Springs of stiffness `elasticity` * edge length; the step is `safety` of a Gershgorin bound.
  SpringBricks(Scene scene, const EnforcementConfig& config, double elasticity, double safety,
               double reach)
      : velocity(scene.x_new.size()), _scene(std::move(scene)), _config(config),
        _part(
            _scene, MPI_COMM_SELF, [](int) { return 0; }, reach) {
    std::vector<double> sum(_scene.x_new.size(), 0);
    for (const auto& element : _scene.elements) {
      const double edge = norm(_scene.x_new[element[1]] - _scene.x_new[element[0]]);
      for (int a = 0; a < 8; ++a)
        for (int b = 0; b < a; ++b) {
          const int i = element[a], j = element[b];
          const double k = elasticity * edge;
          _springs.push_back({i, j, k, norm(_scene.x_new[i] - _scene.x_new[j])});
          sum[i] += k;
          sum[j] += k;
        }
    }
    double largest = 0; // omega^2 <= 2 sum k/m of a node
    for (std::size_t i = 0; i < sum.size(); ++i)
      largest = std::max(largest, 2 * sum[i] / _scene.mass[i]);
    dt = safety * 2 / std::sqrt(largest);
    _config.reference_step = dt;
    _enforcement = std::make_unique<Enforcement>(exec_space(), MPI_COMM_SELF, _part.surface(),
                                                 _part.nodeMass(), _config, _quantum, _scale);
  }

  // Adds edge-to-edge contact.
  void addEdges(const SearchConfig& search) {
    _edges = std::make_unique<EdgeContact>(exec_space(), MPI_COMM_SELF, _part.surface(),
                                           findFeatureEdges(MPI_COMM_SELF, _part.surface()),
                                           _part.nodeMass(), search, 0, _config, _quantum, _scale);
  }

  // Advances by one step; velocity is at n + 1/2 before and after.
  void step() {
    _scene.step();
    double kinetic = 0, exchange = 0;
    for (std::size_t i = 0; i < velocity.size(); ++i) {
      _scene.x_new[i] += dt * velocity[i];
      kinetic +=
          std::isinf(_scene.mass[i]) ? 0 : 0.5 * _scene.mass[i] * dot(velocity[i], velocity[i]);
    }
    const std::vector<Vec3> force_before = _force;
    const double stored_before = _stored;
    addSprings();
    if (!force_before.empty())
      for (std::size_t i = 0; i < velocity.size(); ++i)
        exchange += 0.25 * dt * dot(velocity[i], _force[i] - force_before[i]);
    std::vector<Vec3> acceleration(velocity.size());
    for (std::size_t i = 0; i < velocity.size(); ++i)
      acceleration[i] = (1 / _scene.mass[i]) * _force[i];
    _part.update(_scene);
    const NeutralInput input = _part.neutralInput(_scene, acceleration);
    if (_edges)
      _edges->findCandidates(exec_space(), _part.surface());
    const EnforcementSums both = _enforcement->enforce(
        exec_space(), _part.surface(), _part.ghosts(), _part.pairs(), dt, &input, _edges.get());
    sums = both.nodes;
    edge_sums = both.edges;
    const auto contact = _part.total(*_enforcement, velocity.size(), _scene);
    for (std::size_t i = 0; i < velocity.size(); ++i) {
      const Vec3 f = {static_cast<double>(contact[i][0]), static_cast<double>(contact[i][1]),
                      static_cast<double>(contact[i][2])};
      velocity[i] += dt * (acceleration[i] + (_quantum.value / _scene.mass[i]) * f);
    }
    energy = kinetic + 0.5 * (stored_before + _stored) + exchange +
             sums.terms.sum[spring_stored].value(_scale) +
             edge_sums.terms.sum[spring_stored].value(_scale);
    _taken_by_friction -= sums.terms.sum[friction_work].value(_scale);
    dissipated_by_friction = _taken_by_friction - sums.terms.sum[friction_stored].value(_scale);
  }

  const Scene& scene() const { return _scene; }

  std::vector<Vec3> velocity; // [node]
  double dt = 0;
  double energy = 0; // half-step energy of the last step, before its kick
  double dissipated_by_friction = 0; // up to then, of nodes
  ContactSums sums, edge_sums;

private:
  struct Spring {
    int i, j;
    double stiffness, length;
  };
  void addSprings() {
    _force.assign(velocity.size(), Vec3());
    _stored = 0;
    for (const Spring& s : _springs) {
      const Vec3 d = _scene.x_new[s.j] - _scene.x_new[s.i];
      const double length = norm(d), stretch = length - s.length;
      const Vec3 f = (s.stiffness * stretch / length) * d;
      _force[s.i] += f;
      _force[s.j] -= f;
      _stored += 0.5 * s.stiffness * stretch * stretch;
    }
  }

  Scene _scene;
  EnforcementConfig _config;
  Quantum _quantum = Quantum::forForceScale(100);
  LimbScale _scale = LimbScale::forLargest(1e3);
  ScenePart _part;
  std::unique_ptr<Enforcement> _enforcement;
  std::unique_ptr<EdgeContact> _edges;
  std::vector<Spring> _springs;
  std::vector<Vec3> _force;
  double _stored = 0, _taken_by_friction = 0;
};

} // namespace brickwall::contact::testing
