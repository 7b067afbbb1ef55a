#include "mechanics/central_difference.hpp"

#include <type_traits>

namespace brickwall::mechanics {

void drift(const exec_space& space, double dt, const NodalState& state) {
  const auto u = state.displacement;
  const auto v = state.velocity;
  Kokkos::parallel_for(
      "mechanics::drift::nodes", over(space, static_cast<std::int64_t>(state.mass.extent(0))),
      KOKKOS_LAMBDA(const std::int64_t node) {
        for (int i = 0; i < 3; ++i)
          u(node, i) += dt * v(node, i);
      });
}

namespace {

KOKKOS_INLINE_FUNCTION bool isZero(const Vec3& a) {
  return a.x == 0 && a.y == 0 && a.z == 0;
}

KOKKOS_INLINE_FUNCTION void addVector(KickSums& sums, int first, const Vec3& value,
                                      const LimbScale& scale) {
  for (int i = 0; i < 3; ++i)
    sums.add(first + i, value[i], scale);
}

// The first `kinds` of the force kinds have columns.
template <int kinds>
struct KickNode {
  View<const double*[3]> reference, displacement;
  View<double* [3]> velocity;
  View<const double*> mass;
  View<const unsigned char*> is_owned;
  View<std::int64_t**> forces;
  double quantum, dt;
  BoundaryConditions::AtTime boundary;
  LedgerScales scales;
  SpeedTest test;

  // Sum of all columns, exact, and each kind's force.
  KOKKOS_INLINE_FUNCTION Vec3 totalForce(std::int64_t node, Vec3 (&force)[kinds]) const {
    Vec3 total;
    for (int i = 0; i < 3; ++i) {
      std::int64_t sum = 0;
      for (int kind = 0; kind < kinds; ++kind) {
        const std::int64_t column = forces(node, 3 * kind + i);
        sum += column;
        force[kind][i] = quantum * static_cast<double>(column);
      }
      total[i] = quantum * static_cast<double>(sum);
    }
    return total;
  }

  // The impulse of damping by mass between two velocities: -dt alpha m (old + v)/2.
  KOKKOS_INLINE_FUNCTION Vec3 dampingImpulse(double m, const Vec3& old, const Vec3& v) const {
    return (-0.5 * dt * boundary.mass_damping * m) * (old + v);
  }

  // The new velocity; `reaction` is the impulse that a prescribed motion needed.
  KOKKOS_INLINE_FUNCTION Vec3 newVelocity(std::int64_t node, const Vec3& old, const Vec3& total,
                                          Vec3& reaction) const {
    const double m = mass(node);
    const double per_mass = m > 0 ? dt / m : 0.0; // a node without elements has no mass
    Vec3 v = old + per_mass * total + dt * boundary.gravity;
    if (boundary.mass_damping > 0) {
      const double half = 0.5 * dt * boundary.mass_damping;
      v = (1 / (1 + half)) * (v - half * old);
    }
    if (boundary.any)
      for (int i = 0; i < 3; ++i) {
        const int motion = boundary.motion(node, i);
        if (motion == 0)
          continue;
        v[i] = boundary.velocity[motion][i];
        reaction[i] = m * (v[i] - old[i]) - dt * (total[i] + m * boundary.gravity[i]);
        if (boundary.mass_damping > 0)
          reaction[i] -= dampingImpulse(m, old, v)[i];
      }
    return v;
  }

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t node, KickSums& sums) const {
    const Vec3 old = rowOf(velocity, node);
    Vec3 force[kinds], reaction;
    const Vec3 total = totalForce(node, force);
    const Vec3 v = newVelocity(node, old, total, reaction);
    for (int i = 0; i < 3; ++i)
      velocity(node, i) = v[i];
    if (!is_owned(node))
      return;
    const Vec3 x = rowOf(reference, node) + rowOf(displacement, node), mean = 0.5 * (old + v);
    addEnergies(sums, old, v, mass(node), force);
    addMomenta(sums, x, mass(node) * v, force);
    if (!isZero(reaction))
      addImpulse(sums, x, reaction, mean, kick_work_reaction, kick_impulse_reaction,
                 kick_moment_reaction);
    if (boundary.mass_damping > 0)
      addImpulse(sums, x, dampingImpulse(mass(node), old, v), mean, kick_work_damping,
                 kick_impulse_damping, kick_moment_damping);
    const Vec3 apart = v - test.around;
    if (!(dot(apart, apart) <= test.limit * test.limit))
      ++sums.sum[kick_fast_nodes].high;
  }

  KOKKOS_INLINE_FUNCTION void addEnergies(KickSums& sums, const Vec3& old, const Vec3& v, double m,
                                          const Vec3 (&force)[kinds]) const {
    const Vec3 mean = 0.5 * (old + v), half_momentum = (0.5 * m) * v;
    sums.add(kick_kinetic, dot(half_momentum, v), scales.energy);
    sums.add(kick_shadow, dot(half_momentum, old), scales.energy);
    for (int kind = 0; kind < kinds; ++kind)
      if (!isZero(force[kind]))
        sums.add(kick_work + kind, dt * dot(force[kind], mean), scales.energy);
    if (!isZero(force[material_force]))
      sums.add(kick_power_material, -dot(force[material_force], old), scales.power);
    if (!isZero(force[hourglass_force]))
      sums.add(kick_power_hourglass, -dot(force[hourglass_force], old), scales.power);
  }
  KOKKOS_INLINE_FUNCTION void addMomenta(KickSums& sums, const Vec3& x, const Vec3& momentum,
                                         const Vec3 (&force)[kinds]) const {
    addVector(sums, kick_momentum, momentum, scales.momentum);
    addVector(sums, kick_angular, cross(x, momentum), scales.angular);
    if (!isZero(force[external_force])) {
      const Vec3 impulse = dt * force[external_force];
      addVector(sums, kick_impulse_external, impulse, scales.momentum);
      addVector(sums, kick_moment_external, cross(x, impulse), scales.angular);
    }
    if (!isZero(force[contact_force]))
      addVector(sums, kick_impulse_contact, dt * force[contact_force], scales.momentum);
  }
  // Of what is no force column, with its work and its moment.
  KOKKOS_INLINE_FUNCTION void addImpulse(KickSums& sums, const Vec3& x, const Vec3& impulse,
                                         const Vec3& mean_velocity, int work_term, int impulse_term,
                                         int moment_term) const {
    sums.add(work_term, dot(impulse, mean_velocity), scales.energy);
    addVector(sums, impulse_term, impulse, scales.momentum);
    addVector(sums, moment_term, cross(x, impulse), scales.angular);
  }
};

template <int kinds>
KickSums launchKick(const exec_space& space, int num_nodes, const KickNode<kinds>& functor) {
  KickSums sums;
  Kokkos::parallel_reduce("mechanics::kick::nodes", over(space, num_nodes), functor,
                          Combine<KickSums>(sums));
  space.fence();
  return sums;
}

} // namespace

KickSums kick(const exec_space& space, const HexMesh& mesh, const BoundaryConditions& boundary,
              double time, double dt, const NodalForces& forces, const NodalState& state,
              const LedgerScales& scales, const SpeedTest& test) {
  const auto launch = [&](auto kinds) {
    return launchKick(space, mesh.num_nodes,
                      KickNode<decltype(kinds)::value>{
                          mesh.reference_coordinates, state.displacement, state.velocity,
                          state.mass, mesh.node_is_owned, forces.values, forces.quantum.value, dt,
                          boundary.at(time), scales, test});
  };
  return static_cast<int>(forces.values.extent(1)) == numForceColumns(true)
             ? launch(std::integral_constant<int, num_force_kinds>())
             : launch(std::integral_constant<int, viscous_force>());
}

} // namespace brickwall::mechanics
