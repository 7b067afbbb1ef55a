#include "mechanics/ledger/ledger_sums.hpp"

#include "contact/base/fixed_point.hpp"
#include "contact/base/mpi.hpp"
#include "mechanics/element/hex8_geometry.hpp"

#include <cmath>

namespace brickwall::mechanics {

namespace {

struct MeshExtremes {
  double force = 0; // (lambda + 2 mu) h^2
  double edge = 0; // h
  double fastest = 0; // sqrt((lambda + 2 mu)/rho)
  double inverse_slowest = 0;
  double farthest = 0; // coordinate magnitude
  double inverse_softest = 0; // 1/(mu h), of the least shear stiffness
  KOKKOS_INLINE_FUNCTION MeshExtremes& operator+=(const MeshExtremes& b) {
    force = maxOf(force, b.force);
    edge = maxOf(edge, b.edge);
    fastest = maxOf(fastest, b.fastest);
    inverse_slowest = maxOf(inverse_slowest, b.inverse_slowest);
    farthest = maxOf(farthest, b.farthest);
    inverse_softest = maxOf(inverse_softest, b.inverse_softest);
    return *this;
  }
};

MeshExtremes extremesOf(const exec_space& space, const MeshViews& m, int num_elems) {
  MeshExtremes result;
  Kokkos::parallel_reduce(
      "mechanics::ledgerScales::elements", rangePolicy(space, num_elems),
      KOKKOS_LAMBDA(const std::int64_t elem, MeshExtremes& sum) {
        CornerCoordinates X;
        gatherCorners(m.elem_to_nodes, m.reference_coordinates, static_cast<int>(elem), X);
        const Material material = m.materials(m.elem_block(elem));
        const double modulus = material.lambda() + 2 * material.mu();
        const double speed = std::sqrt(modulus / material.density);
        MeshExtremes one;
        one.edge = longestEdge(X);
        one.force = modulus * one.edge * one.edge;
        one.fastest = speed;
        one.inverse_slowest = 1 / speed;
        one.inverse_softest = 1 / (material.mu() * one.edge);
        for (int c = 0; c < 8; ++c)
          for (int j = 0; j < 3; ++j)
            one.farthest = maxOf(one.farthest, std::fabs(X[c][j]));
        sum += one;
      },
      PlusReducer<MeshExtremes>(result));
  return result;
}

// Energy of all elements' shear springs under forces of 128 quanta, a bound of many roundings.
// Nearly incompressible materials have coarse quanta, since these follow the bulk stiffness.
double noiseOfForces(double largest_force, double inverse_softest, std::int64_t num_elems) {
  constexpr double quanta = 128;
  const double force = quanta * Quantum::forForceScale(largest_force).value;
  return static_cast<double>(num_elems) * force * force * inverse_softest;
}

// Effect of the rounding of terms to the last limb on a sum over elements or nodes, times a factor.
double noiseOfSums(const LimbScale& scale, std::int64_t num_elems, double factor) {
  return factor * 0.5 * scale.tail_quantum * static_cast<double>(num_elems);
}
constexpr double momenta_over_rounding = 1e11; // so that the error after many steps is below 1e-10

} // namespace

LedgerScales ledgerScales(const exec_space& space, MPI_Comm comm, const HexMesh& mesh) {
  const MeshExtremes local = extremesOf(space, viewsOf(mesh), mesh.num_elems);
  double e[6] = {local.force,           local.edge,     local.fastest,
                 local.inverse_slowest, local.farthest, local.inverse_softest};
  allReduce(comm, e, 6, MPI_MAX);
  const auto num_elems = allReduce(comm, static_cast<std::int64_t>(mesh.num_elems), MPI_SUM);
  constexpr double headroom = 1048576; // 2^20
  const double energy = headroom * e[0] * e[1], momentum = energy * e[3], mass = momentum * e[3];
  const double distance = e[4] + e[1];
  const LimbScale energy_scale = LimbScale::forLargest(energy),
                  momentum_scale = LimbScale::forLargest(momentum),
                  angular_scale = LimbScale::forLargest(momentum * distance);
  return {energy_scale,
          LimbScale::forLargest(headroom * e[0] * e[2]),
          momentum_scale,
          angular_scale,
          LimbScale::forLargest(mass * distance),
          LimbScale::forLargest(mass * distance * distance),
          maxOf(noiseOfSums(energy_scale, num_elems, energies_over_rounding),
                noiseOfForces(e[0], e[5], num_elems)),
          noiseOfSums(momentum_scale, num_elems, momenta_over_rounding),
          noiseOfSums(angular_scale, num_elems, momenta_over_rounding)};
}

MotionSums motionOf(const exec_space& space, const HexMesh& mesh, const NodalState& state,
                    const LedgerScales& scales) {
  const MeshViews m = viewsOf(mesh);
  const NodalState s = state;
  MotionSums result;
  Kokkos::parallel_reduce(
      "mechanics::motionOf::nodes", rangePolicy(space, mesh.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node, MotionSums& sums) {
        if (!m.node_is_owned(node))
          return;
        const double mass = s.mass(node);
        const Vec3 v = rowOf(s.velocity, node), momentum = mass * v;
        const Vec3 x = rowOf(m.reference_coordinates, node) + rowOf(s.displacement, node);
        const Vec3 angular = cross(x, momentum);
        sums.add(motion_kinetic, 0.5 * dot(momentum, v), scales.energy);
        sums.add(motion_inertia, mass * dot(x, x), scales.inertia);
        for (int i = 0; i < 3; ++i) {
          sums.add(motion_momentum + i, momentum[i], scales.momentum);
          sums.add(motion_angular + i, angular[i], scales.angular);
          sums.add(motion_first_moment + i, mass * x[i], scales.first_moment);
        }
      },
      PlusReducer<MotionSums>(result));
  return result;
}

} // namespace brickwall::mechanics
