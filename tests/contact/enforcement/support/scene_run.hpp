// A scene of bricks with its contact enforcement, stepped explicitly.
#pragma once

#include "contact/base/to_device.hpp"
#include "tests/contact/enforcement/support/brick_scene.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

namespace brickwall::contact::testing {

constexpr double dt = 0.1;

inline EnforcementConfig config() {
  EnforcementConfig c;
  c.scheme = Scheme::penalty;
  c.reference_step = dt;
  return c;
}
inline Quantum quantum() {
  return Quantum::forForceScale(100);
}
inline LimbScale energyScale() {
  return LimbScale::forLargest(1e3);
}

// The first rows of a view of one or two dimensions, row by row.
template <class ViewType>
std::vector<double> numbersOf(const ViewType& view, std::size_t rows) {
  const auto host = toHost(view);
  std::vector<double> all;
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t j = 0; j < (ViewType::rank == 2 ? host.extent(1) : 1); ++j)
      all.push_back(static_cast<double>(host.data()[i * host.stride(0) + j * host.stride(1)]));
  return all;
}

// A scene on the ranks of `comm` with its enforcement.
struct SceneRun {
  template <class Cut>
  SceneRun(const Scene& s, MPI_Comm comm, const Cut& cut, const EnforcementConfig& c = config(),
           double reach = 0.3)
      : scene(s), part(s, comm, cut, reach),
        enforcement(exec_space(), comm, part.surface(), part.nodeMass(), c, quantum(),
                    energyScale()) {}
  // Collective. Forces of all nodes at the present coordinates of the scene. No other forces act.
  std::vector<std::array<std::int64_t, 3>> step() {
    part.update(scene);
    const NeutralInput neutral =
        part.neutralInput(scene, std::vector<Vec3>(scene.x_new.size(), {0, 0, 0}));
    sums =
        enforcement.enforce(exec_space(), part.surface(), part.ghosts(), part.pairs(), dt, &neutral)
            .nodes;
    sumOverRanks(part.comm(), sums);
    return part.total(enforcement, scene.x_new.size(), scene);
  }
  // The same after a further motion of a body.
  std::vector<std::array<std::int64_t, 3>> moveAndStep(int body, const Vec3& by) {
    scene.step();
    scene.move(body, by);
    return step();
  }
  // The interactions of an owned node.
  std::vector<Interaction> of(int node) const {
    std::vector<Interaction> found;
    const auto& h = enforcement.history();
    const auto all = toHost(h.interactions);
    for (std::int64_t i = 0; i < h.count; ++i)
      if (part.nodes()[all(i).node] == node)
        found.push_back(all(i));
    std::sort(found.begin(), found.end(),
              [](const Interaction& a, const Interaction& b) { return a.side < b.side; });
    return found;
  }

  Scene scene;
  ScenePart part;
  Enforcement enforcement;
  ContactSums sums;
};

// A brick pressed into another one.
inline Scene pressed() {
  Scene scene;
  scene.addBox({0, 0, 0}, {1, 1, 1}, {3, 3, 3});
  const int upper = scene.addBox({0.11, 0.07, 0.98}, {1, 1, 1}, {3, 3, 3});
  scene.cameBy(upper, {0, 0, -0.03});
  return scene;
}

inline int onOneRank(int) {
  return 0;
}
inline int scattered(int element) {
  return (element * 7 + element / 3) % sizeOf(MPI_COMM_WORLD);
}
inline std::unique_ptr<SceneRun> alone(const Scene& scene, const EnforcementConfig& c = config(),
                                       double reach = 0.3) {
  return std::make_unique<SceneRun>(scene, MPI_COMM_SELF, onOneRank, c, reach);
}

} // namespace brickwall::contact::testing
