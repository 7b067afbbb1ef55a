#include "mechanics/loads/pressure_load.hpp"

#include "mechanics/mesh/host_mesh.hpp"

namespace brickwall::mechanics {

namespace {

// Adds one face's loads and counts the corners whose load does not fit the fixed-point range.
struct AddPressure {
  MeanPressure pressure;
  bool follower;
  View<int* [4]> face_to_nodes;
  View<const double*[3]> reference, displacement;
  View<std::int64_t**> forces;
  double inverse_quantum;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t face, std::int64_t& misfits) const {
    Vec3 X[4], x[4], load[4];
    for (int c = 0; c < 4; ++c) {
      const int node = face_to_nodes(face, c);
      X[c] = rowOf(reference, node);
      x[c] = follower ? X[c] + rowOf(displacement, node) : X[c];
    }
    quadPressureLoads(pressure, X, x, load);
    for (int c = 0; c < 4; ++c)
      misfits += addCorner(face_to_nodes(face, c), inverse_quantum * load[c]) ? 0 : 1;
  }
  KOKKOS_INLINE_FUNCTION bool addCorner(int node, const Vec3& quanta) const {
    for (int i = 0; i < 3; ++i)
      if (!fitsFixedPoint(quanta[i]))
        return false;
    for (int i = 0; i < 3; ++i)
      if (const std::int64_t rounded = roundToFixed(quanta[i]); rounded != 0)
        Kokkos::atomic_add(&forces(node, 3 * external_force + i), rounded);
    return true;
  }
};

// Largest distance of a corner from the centre; no point of a face is farther away.
double farthestCorner(const exec_space& space, const HexMesh& mesh, const Vec3& centre,
                      const View<int* [4]>& face_to_nodes) {
  const auto X = mesh.reference_coordinates;
  double square = 0;
  Kokkos::parallel_reduce(
      "mechanics::PressureLoad::farthestCorner",
      rangePolicy(space, static_cast<std::int64_t>(face_to_nodes.extent(0))),
      KOKKOS_LAMBDA(const std::int64_t face, double& largest) {
        for (int c = 0; c < 4; ++c) {
          const Vec3 away = rowOf(X, face_to_nodes(face, c)) - centre;
          largest = maxOf(largest, dot(away, away));
        }
      },
      Kokkos::Max<double>(square));
  space.fence();
  return std::sqrt(maxOf(square, 0.0));
}

} // namespace

PressureLoad::PressureLoad(const exec_space& space, const HexMesh& mesh, const Pressure& pressure,
                           const std::vector<int>& face_to_nodes)
    : _pressure(pressure), _face_to_nodes(toDevice<View<int* [4]>>(
                               space, "mechanics::PressureLoad::face_to_nodes", face_to_nodes)) {
  if (pressure.shape.kind == PulseKind::constant)
    return;
  const double farthest =
      pressure.gaussian ? farthestCorner(space, mesh, pressure.centre, _face_to_nodes) : 0;
  const double delay = farthest / pressure.speed;
  _end = pressure.start + pressure.shape.duration + delay;
  _end += 1e-12 * (std::fabs(pressure.start) + pressure.shape.duration + delay);
}

std::int64_t PressureLoad::add(const exec_space& space, const HexMesh& mesh,
                               const View<const double* [3]>& displacement, const TimeSpan& span,
                               const NodalForces& forces) const {
  const MeanPressure mean(_pressure, span);
  if (span.begin > _end || mean.isZero())
    return 0;
  std::int64_t misfits = 0;
  const AddPressure functor{
      mean,         _pressure.follower, _face_to_nodes,        mesh.reference_coordinates,
      displacement, forces.values,      forces.quantum.inverse};
  Kokkos::parallel_reduce("mechanics::PressureLoad::add",
                          rangePolicy(space, static_cast<std::int64_t>(_face_to_nodes.extent(0))),
                          functor, Kokkos::Sum<std::int64_t>(misfits));
  space.fence();
  return misfits;
}

} // namespace brickwall::mechanics
