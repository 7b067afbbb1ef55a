// Scenes of edges that cross, stepped explicitly.
#pragma once

#include "contact/enforcement/edge_edge/edge_contact.hpp"
#include "contact/enforcement/edge_edge/edge_edge_kinematics.hpp"
#include "tests/contact/enforcement/support/scene_run.hpp"

namespace brickwall::contact::testing {

// Two bricks with elements of edge length 1, each with an edge towards the other: the lower one's
// ridge along x at z = 0, the upper one's along y at z = gap. Both are three elements long, so that
// they cross between nodes.
inline Scene crossedRidges(double gap, int n = 3) {
  const double c = std::sqrt(0.5), side = n;
  Scene scene;
  scene.addBrick({side, side, side}, {n, n, n}, 1, [&](const Vec3& p) {
    const double y = p.y - side, z = p.z - side; // the edge y = z = side is the ridge
    return Vec3{p.x - 0.5 * side, c * (y - z), c * (y + z)};
  });
  scene.addBrick({side, side, side}, {n, n, n}, 1, [&](const Vec3& p) {
    return Vec3{c * (p.x - p.z), p.y - 0.5 * side + 0.013, gap + c * (p.x + p.z)};
  });
  return scene;
}

// Bars of side 0.2 and length 3 at right angles. The top of the lower one is at z = 0; its elements
// are as long as the bar. The upper one has `n` elements; it is rolled about its own axis,
// inclined, and placed so that its lowest point over the lower bar is at z = gap.
inline Scene crossedBars(double gap, double rolled, double inclined, int n = 3) {
  Scene scene;
  scene.addBrick({3, 0.2, 0.2}, {3, 1, 1}, 1, [](const Vec3& p) {
    return Vec3{p.x - 1.5, p.y - 0.1, p.z - 0.2};
  });
  const double cr = std::cos(rolled), sr = std::sin(rolled);
  const double ci = std::cos(inclined), si = std::sin(inclined);
  const double lowest = -0.1 * (cr + std::fabs(sr)) * ci - 0.1 * std::fabs(si);
  scene.addBrick({0.2, 3, 0.2}, {1, n, 1}, 1, [&](const Vec3& p) {
    const Vec3 q = {p.x - 0.1, p.y - 1.5 + 0.013, p.z - 0.1};
    const double x = cr * q.x - sr * q.z, z = sr * q.x + cr * q.z;
    return Vec3{x + 0.017, ci * q.y - si * z, si * q.y + ci * z + gap - lowest};
  });
  return scene;
}

inline SearchConfig searchOf(double reach) {
  SearchConfig search;
  search.node_tolerance = search.face_tolerance = 0.5 * reach;
  search.drop_same_body = true;
  return search;
}

// The edges of a scene with their forces on the nodes of the part.
struct EdgeRun {
  template <class Cut>
  EdgeRun(const Scene& s, MPI_Comm comm, const Cut& cut, EnforcementConfig c = config(),
          double margin = 0)
      : scene(s), part(s, comm, cut, 0.3), motion(exec_space(), "test", part.surface()),
        total("test::edge_forces", part.surface().num_nodes) {
    c.reference_step = dt;
    edges = std::make_unique<EdgeContact>(
        exec_space(), comm, part.surface(), findFeatureEdges(comm, part.surface()), part.nodeMass(),
        searchOf(0.2), margin, c, Quantum::forForceScale(100), LimbScale::forLargest(1e3));
  }
  // Collective. Forces of all nodes.
  std::vector<std::array<std::int64_t, 3>> step() {
    part.update(scene);
    edges->findCandidates(exec_space(), part.surface());
    motion.update(exec_space(), part.surface());
    sums = edges->select(exec_space(), dt, motion)();
    edges->setHasForcesAnywhere(brickwall::allReduce(part.comm(), sums.interactions, MPI_MAX) > 0);
    TouchedNodes touched("test", part.surface().num_nodes);
    edges->addTouched(exec_space(), touched);
    Kokkos::deep_copy(total, 0);
    edges->collectForces(exec_space(), total);
    edges->advance(dt);
    sumOverRanks(part.comm(), sums);
    ContactForces forces{total, View<std::int64_t* [12]>("test::none", part.ghosts().count)};
    return part.total(forces, scene.x_new.size(), scene);
  }
  void move(int body, const Vec3& by) {
    scene.step();
    scene.move(body, by);
  }
  Scene scene;
  ScenePart part;
  SurfaceMotion motion;
  View<std::int64_t* [3]> total;
  std::unique_ptr<EdgeContact> edges;
  ContactSums sums;
};

} // namespace brickwall::contact::testing
