#include "miniapp/scene/loads.hpp"

#include "contact/base/mpi.hpp"
#include "io/wall/wall_layout.hpp"
#include "mechanics/loads/initial_conditions.hpp"

#include <cmath>

namespace brickwall::miniapp {

namespace {

// Marks the local elements that an entry selects.
std::vector<unsigned char> chosenElements(const Config& config, const Scene& scene,
                                          const InitialSelection& entry) {
  const auto& part = scene.part;
  std::vector<unsigned char> chosen(part.elem_ids.size(), 1);
  if (entry.block) {
    for (std::size_t elem = 0; elem < chosen.size(); ++elem)
      chosen[elem] = part.blocks[part.elem_block[elem]].name == *entry.block;
  } else if (entry.brick) {
    const io::WallLayout layout(*config.wall);
    for (std::size_t elem = 0; elem < chosen.size(); ++elem) {
      const auto place = layout.brickPlace(part.elem_body[elem]);
      chosen[elem] = place.along == (*entry.brick)[0] && place.wythe == (*entry.brick)[1] &&
                     place.course == (*entry.brick)[2];
    }
  } else if (entry.body) {
    for (std::size_t elem = 0; elem < chosen.size(); ++elem)
      chosen[elem] = part.elem_body[elem] == *entry.body;
  }
  return chosen;
}

} // namespace

mechanics::PulseShape toPulseShape(const PulseConfig& pulse) {
  mechanics::PulseShape shape;
  shape.kind = pulse.shape;
  if (pulse.duration)
    shape.duration = *pulse.duration;
  shape.decay = pulse.decay;
  return shape;
}

Vec3 prescribedVelocity(const PrescribedVelocityConfig& prescribed) {
  Vec3 velocity = toVec3(prescribed.velocity);
  for (int d = 0; d < 3; ++d)
    if (!prescribed.components[d])
      velocity[d] = 0;
  return velocity;
}

std::vector<mechanics::PrescribedMotion> prescribedMotions(const Config& config,
                                                           const io::MeshPart& part) {
  std::vector<mechanics::PrescribedMotion> motions;
  for (const auto& fixed : config.fixed) {
    mechanics::PrescribedMotion motion;
    motion.nodes = nodeSetOf(part, fixed.node_set).nodes;
    for (int d = 0; d < 3; ++d)
      motion.component[d] = fixed.components[d];
    motions.push_back(motion);
  }
  for (const auto& prescribed : config.prescribed) {
    mechanics::PrescribedMotion motion;
    motion.nodes = nodeSetOf(part, prescribed.node_set).nodes;
    for (int d = 0; d < 3; ++d)
      motion.component[d] = prescribed.components[d];
    motion.velocity = toVec3(prescribed.velocity);
    motion.shape = toPulseShape(prescribed.pulse);
    motion.start = prescribed.pulse.start;
    motions.push_back(motion);
  }
  return motions;
}

std::vector<mechanics::PressureLoad> pressureLoads(const exec_space& space, MPI_Comm comm,
                                                   const Config& config, const Scene& scene) {
  std::vector<mechanics::PressureLoad> loads;
  for (const auto& entry : config.pressures) {
    mechanics::Pressure pressure;
    pressure.peak = entry.peak;
    pressure.shape = toPulseShape(entry.pulse);
    pressure.start = entry.pulse.start;
    pressure.follower = entry.follower;
    if (entry.distribution == Distribution::gaussian) {
      pressure.gaussian = true;
      pressure.centre = toVec3(entry.center);
      pressure.radius = entry.radius / std::sqrt(2.0); // the deck defines the radius by exp(-1)
      if (entry.wave_speed > 0)
        pressure.speed = entry.wave_speed;
    }
    const auto& sides = sideSetOf(scene.part, entry.side_set);
    loads.emplace_back(space, comm, scene.mesh, pressure,
                       mechanics::sideNodes(scene.mesh, sides.elems, sides.sides));
  }
  return loads;
}

void setInitialVelocities(const exec_space& space, const Config& config, const Scene& scene,
                          mechanics::SharedNodeSum& shared,
                          const mechanics::BoundaryConditions& boundary,
                          const mechanics::NodalState& state) {
  for (const auto& entry : config.initial_velocities)
    mechanics::setInitialField(space, scene.mesh, shared, chosenElements(config, scene, entry),
                               mechanics::rigidVelocity(toVec3(entry.velocity),
                                                        toVec3(entry.angular_velocity),
                                                        toVec3(entry.center)),
                               state.velocity);
  if (!boundary.any())
    return;
  const auto at_start = boundary.during({});
  const auto velocity = state.velocity;
  Kokkos::parallel_for(
      "miniapp::setInitialVelocities", rangePolicy(space, scene.mesh.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node) {
        for (int d = 0; d < 3; ++d)
          if (at_start.motion(node, d))
            velocity(node, d) = at_start.velocityOf(at_start.motion(node, d))[d];
      });
}

void setInitialDeformations(const exec_space& space, const Config& config, const Scene& scene,
                            mechanics::SharedNodeSum& shared, const mechanics::NodalState& state) {
  for (const auto& entry : config.initial_deformations) {
    mechanics::AffineField field;
    for (int k = 0; k < 9; ++k)
      field.gradient(k / 3, k % 3) = entry.gradient[static_cast<std::size_t>(k)];
    field.center = toVec3(entry.center);
    mechanics::setInitialField(space, scene.mesh, shared, chosenElements(config, scene, entry),
                               field, state.displacement);
  }
}

} // namespace brickwall::miniapp
