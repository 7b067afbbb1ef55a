#include "miniapp/output/contact_pressure.hpp"

#include "contact/base/to_device.hpp"

namespace brickwall::miniapp {

namespace {

// Least cosine between the force on a node and the inward normal of a face that it presses.
constexpr double pressed_cosine = 0.1;

// Adds the areas of this rank's faces that are pressed, seen along the forces [mesh node], to
// `areas` [mesh node][1].
void addPressedAreas(const exec_space& space, const Scene& scene,
                     const View<const double* [3]>& displacement,
                     const View<const std::int64_t* [3]>& forces, const Quantum& quantum,
                     const View<std::int64_t**>& areas) {
  const auto X = scene.mesh.reference_coordinates;
  const auto face_to_nodes = scene.skin.face_to_nodes;
  Kokkos::parallel_for(
      "miniapp::contactPressure::addPressedAreas", rangePolicy(space, scene.skin.num_faces),
      KOKKOS_LAMBDA(const std::int64_t face) {
        const double unit[4] = {1, 1, 1, 1};
        brickwall::Triple<double> x[4], inward[4];
        for (int c = 0; c < 4; ++c) {
          const int node = face_to_nodes(face, c);
          x[c] = triple(rowOf(X, node) + rowOf(displacement, node));
        }
        mechanics::quadPressureLoads(unit, x, inward);
        for (int c = 0; c < 4; ++c) {
          const int at = face_to_nodes(face, c);
          const Vec3 force = {static_cast<double>(forces(at, 0)),
                              static_cast<double>(forces(at, 1)),
                              static_cast<double>(forces(at, 2))};
          const Vec3 area = {inward[c].x, inward[c].y, inward[c].z};
          const double along = dot(force, area), size = norm(force);
          if (along > pressed_cosine * size * norm(area))
            Kokkos::atomic_add(&areas(at, 0), roundToFixed(quantum.inverse * (along / size)));
        }
      });
}

} // namespace

std::vector<double> contactPressure(Simulation& simulation, mechanics::SharedNodeSum& shared) {
  const exec_space space;
  const Scene& scene = simulation.scene();
  std::vector<double> pressure(scene.part.node_ids.size());
  if (!simulation.contact()->hasForces())
    return pressure;
  const auto forces = simulation.contact()->normalForces(simulation.forceQuantum(), shared);
  // Faces may stretch: areas up to 32 times that of the longest edge squared fit.
  const Quantum quantum = Quantum::forForceScale(8 * scene.longest_edge * scene.longest_edge);
  const View<std::int64_t**> areas("miniapp::contactPressure::areas", pressure.size(), 1);
  addPressedAreas(space, scene, simulation.state().displacement, forces, quantum, areas);
  shared.sum(space, areas);
  const auto host_areas = toHost(areas);
  const auto host_forces = toHost(forces);
  for (std::size_t node = 0; node < pressure.size(); ++node) {
    double square = 0;
    for (int d = 0; d < 3; ++d) {
      const double force =
          simulation.forceQuantum().value * static_cast<double>(host_forces(node, d));
      square += force * force;
    }
    if (host_areas(node, 0) > 0)
      pressure[node] =
          std::sqrt(square) / (quantum.value * static_cast<double>(host_areas(node, 0)));
  }
  return pressure;
}

} // namespace brickwall::miniapp
