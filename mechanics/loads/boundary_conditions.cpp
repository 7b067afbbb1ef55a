#include "mechanics/loads/boundary_conditions.hpp"

#include "contact/base/error.hpp"
#include "mechanics/mesh/host_mesh.hpp"

namespace brickwall::mechanics {

BoundaryConditions::BoundaryConditions(const exec_space& space, int num_nodes,
                                       const std::vector<PrescribedMotion>& motions,
                                       const Vec3& gravity, double mass_damping)
    : _motions(motions), _gravity(gravity), _mass_damping(mass_damping) {
  if (motions.size() > max_motions)
    throw InputError("BoundaryConditions: found " + std::to_string(motions.size()) +
                     " prescribed motions, expected at most " + std::to_string(max_motions));
  std::vector<unsigned char> motion_of(3 * static_cast<std::size_t>(num_nodes), 0);
  for (std::size_t m = 0; m < motions.size(); ++m)
    for (const int node : motions[m].nodes) {
      if (node < 0 || node >= num_nodes)
        throw InputError("BoundaryConditions: found node " + std::to_string(node) + " in motion " +
                         std::to_string(m) + ", expected a local node, 0 to " +
                         std::to_string(num_nodes - 1));
      for (int i = 0; i < 3; ++i)
        if (motions[m].component[i])
          motion_of[3 * static_cast<std::size_t>(node) + i] = static_cast<unsigned char>(m + 1);
    }
  _motion_of = toDevice<View<unsigned char* [3]>>(space, "mechanics::BoundaryConditions::motion_of",
                                                  motion_of);
  for (PrescribedMotion& motion : _motions)
    motion.nodes.clear();
}

BoundaryConditions::DuringStep BoundaryConditions::during(const TimeSpan& drift) const {
  DuringStep result;
  result.motion = _motion_of;
  result.gravity = _gravity;
  result.mass_damping = _mass_damping;
  result.any = any();
  for (auto& velocity : result.velocity)
    velocity[0] = velocity[1] = velocity[2] = 0;
  for (std::size_t m = 0; m < _motions.size(); ++m) {
    const double start = _motions[m].start;
    const Vec3 velocity =
        _motions[m].shape.mean({drift.begin - start, drift.end - start}) * _motions[m].velocity;
    for (int i = 0; i < 3; ++i)
      result.velocity[m + 1][i] = velocity[i];
  }
  return result;
}

} // namespace brickwall::mechanics
