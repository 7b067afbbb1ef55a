// What acts on every node by itself: prescribed motion by component (fixed = velocity zero), gravity, and damping by mass.
// Velocities are prescribed at half steps, as the mean over the drift to come, so that positions follow exactly; reactions are
// booked by the kick.
#pragma once

#include "contact/base/vec3.hpp"
#include "mechanics/loads/pulse_shape.hpp"
#include "mechanics/mesh/hex_mesh.hpp"

namespace brickwall::mechanics {

// Velocity of some components of a set of nodes; the default fixes all three.
struct PrescribedMotion {
  std::vector<int> nodes; // local; a shared node must be listed on every rank that shares it
  bool component[3] = {true, true, true}; // which of x, y, z
  Vec3 velocity; // peak, length/time
  PulseShape shape; // factor of the velocity in time since `start`
  double start = 0; // time
};

class BoundaryConditions {
public:
  static constexpr int max_motions = 31;

  // A component that several motions name follows the last of them. The list of motions must be the same on all
  // ranks (their node lists differ). `mass_damping` is alpha of f = -alpha m v, 1/time, >= 0; on prescribed components the
  // reaction takes it up. Throws InputError for more than max_motions or a bad node.
  BoundaryConditions(const exec_space& space, int num_nodes,
                     const std::vector<PrescribedMotion>& motions, const Vec3& gravity,
                     double mass_damping = 0);

  // What a kernel needs for one step.
  struct DuringStep {
    View<const unsigned char* [3]> motion; // [node][xyz] 0 free, else index into velocity
    double velocity[max_motions + 1][3]; // means over the step, length/time
    Vec3 gravity; // length/time^2
    double mass_damping = 0; // 1/time
    bool any = false; // false: no component is prescribed
  };
  DuringStep during(const TimeSpan& drift) const;

  View<const unsigned char* [3]> motion() const { return _motion_of; } // DuringStep::motion

  const Vec3& gravity() const {
    return _gravity;
  }
  double massDamping() const { return _mass_damping; }
  bool any() const { return !_motions.empty(); }

private:
  std::vector<PrescribedMotion> _motions; // without nodes
  View<unsigned char* [3]> _motion_of;
  Vec3 _gravity;
  double _mass_damping;
};

} // namespace brickwall::mechanics
