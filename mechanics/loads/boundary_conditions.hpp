// Conditions that act on each node separately: prescribed motion by component (fixed: velocity
// zero), gravity, and mass-proportional damping. Velocities are prescribed at half steps as the
// mean over the following drift, so that positions are exact; the kick adds reactions to the
// ledger. theory.md, equations (18) and (19).
#pragma once

#include "contact/base/vec3.hpp"
#include "mechanics/loads/pulse_shape.hpp"
#include "mechanics/mesh/hex_mesh.hpp"

#include <utility>
#include <vector>

namespace brickwall::mechanics {

// Velocity of some components of a set of nodes; by default all three are fixed.
struct PrescribedMotion {
  std::vector<int> nodes; // local; a shared node must be listed on every rank that shares it
  bool component[3] = {true, true, true}; // x, y, z
  Vec3 velocity; // peak, length/time
  PulseShape shape; // factor of the velocity as a function of the time since `start`
  double start = 0; // time
};

class BoundaryConditions {
public:
  static constexpr int max_motions = 31;

  // A component that several motions name follows the last of them. The list of motions must be the
  // same on all ranks, with each rank's own nodes. `mass_damping` is alpha of f = -alpha m v,
  // 1/time, >= 0; on prescribed components the reaction balances it. Throws InputError for more
  // than max_motions or a node out of range.
  BoundaryConditions(const exec_space& space, int num_nodes,
                     const std::vector<PrescribedMotion>& motions, const Vec3& gravity,
                     double mass_damping = 0);

  // Data of one step for kernels.
  struct DuringStep {
    View<const unsigned char* [3]> motion; // [node][xyz] 0: free, otherwise index into velocity
    double velocity[max_motions + 1][3]; // mean over the step, length/time
    Vec3 gravity; // length/time^2
    double mass_damping = 0; // 1/time
    bool any = false; // whether any component is prescribed

    // velocity[index] by constant indices, see NodalForces::acts.
    KOKKOS_INLINE_FUNCTION Vec3 velocityOf(int index) const {
      return select(index, std::make_integer_sequence<int, max_motions + 1>());
    }

  private:
    template <int... number>
    KOKKOS_INLINE_FUNCTION Vec3 select(int index, std::integer_sequence<int, number...>) const {
      Vec3 selected;
      ((selected = number == index
                       ? Vec3{velocity[number][0], velocity[number][1], velocity[number][2]}
                       : selected),
       ...);
      return selected;
    }
  };
  DuringStep during(const TimeSpan& drift) const;

  View<const unsigned char* [3]> motion() const { return _motion_of; } // as DuringStep::motion

  const Vec3& gravity() const {
    return _gravity;
  }
  double massDamping() const { return _mass_damping; }
  bool any() const { return !_motions.empty(); }

private:
  std::vector<PrescribedMotion> _motions; // node lists cleared
  View<unsigned char* [3]> _motion_of;
  Vec3 _gravity;
  double _mass_damping;
};

} // namespace brickwall::mechanics
