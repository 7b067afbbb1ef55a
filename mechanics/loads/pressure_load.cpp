#include "mechanics/loads/pressure_load.hpp"

#include "contact/base/fixed_pack.hpp"
#include "contact/base/lane_arrays.hpp"
#include "contact/base/mpi.hpp"
#include "mechanics/mesh/host_mesh.hpp"

#include <algorithm>
#include <numeric>

namespace brickwall::mechanics {

namespace {

constexpr int W = simd_width;

template <int columns>
using Columns = Kokkos::View<const double* [columns], Kokkos::LayoutLeft, memory_space>;

// Computes the corner loads of W faces at a time, and counts those that do not fit the fixed-point
// range, which become 0.
struct ComputeFaceLoads {
  MeanPressure pressure;
  bool follower, gaussian;
  View<const int* [4]> face_to_nodes;
  View<const double*[3]> reference, displacement;
  Columns<4> attenuation, delay;
  Kokkos::View<std::int64_t* [12], Kokkos::LayoutLeft, memory_space> loads;
  double inverse_quantum;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t pack, std::int64_t& misfits) const {
    const int first = static_cast<int>(pack) * W;
    const int count = minOf(W, static_cast<int>(face_to_nodes.extent(0)) - first);
    LaneTriple<Lanes> corners[4];
    Triple<Lanes> x[4], load[4];
    Lanes mean[4];
    prefetchCorners(first + 4 * W);
    for (int lane = 0; lane < W; ++lane) // those without a face repeat the last one
      gather(first + minOf(lane, count - 1), lane, corners);
    for (int c = 0; c < 4; ++c) {
      x[c] = corners[c];
      mean[c] = gaussian ? gaussianAt(first, count, c) : Lanes(pressure.afterDelay(0));
    }
    quadPressureLoads(mean, x, load);
    for (int c = 0; c < 4; ++c) {
      const Triple<Lanes> quanta = Lanes(inverse_quantum) * load[c];
      const MaskOf<Lanes>::type fits =
          fitsFixedPoint(quanta.x) & fitsFixedPoint(quanta.y) & fitsFixedPoint(quanta.z);
      if (isAny(!fits))
        for (int lane = 0; lane < count; ++lane)
          misfits += laneOf(where(fits, Lanes(0.0), Lanes(1.0)), lane) != 0;
      const Lanes parts[3] = {quanta.x, quanta.y, quanta.z};
      for (int i = 0; i < 3; ++i)
        storeLanes(toFixed(where(fits, parts[i], Lanes(0.0))), &loads(first, 3 * c + i));
    }
  }
  // Asks for rows of the corners of W faces; neighbours have the others.
  KOKKOS_FORCEINLINE_FUNCTION void prefetchCorners(int first) const {
    for (int face = first; face < first + W; face += 3)
      if (face < static_cast<int>(face_to_nodes.extent(0)))
        for (int c = 0; c < 4; ++c) {
          prefetch(&reference(face_to_nodes(face, c), 0));
          prefetch(&displacement(face_to_nodes(face, c), 0));
        }
  }
  KOKKOS_FORCEINLINE_FUNCTION void gather(int face, int lane,
                                          LaneTriple<Lanes> (&corners)[4]) const {
    for (int c = 0; c < 4; ++c) {
      const int node = face_to_nodes(face, c);
      const Vec3 X = rowOf(reference, node);
      corners[c].set(lane, follower ? X + rowOf(displacement, node) : X);
    }
  }
  KOKKOS_INLINE_FUNCTION Lanes gaussianAt(int first, int count, int point) const {
    const Lanes factor = loadLanes<Lanes>(&attenuation(first, point));
    if (!pressure.isWave())
      return Lanes(pressure.afterDelay(0)) * factor;
    Lanes without_distance = Lanes(0.0);
    for (int lane = 0; lane < count; ++lane)
      setLane(without_distance, lane, pressure.afterDelay(delay(first + lane, point)));
    return without_distance * factor;
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
  return std::sqrt(maxOf(square, 0.0));
}

// Attenuation and delay [face][QuadPoint] of a pressure.
template <class FaceColumns>
void computeFactors(const exec_space& space, const HexMesh& mesh, const Pressure& pressure,
                    const View<int* [4]>& face_to_nodes, const FaceColumns& attenuation,
                    const FaceColumns& delay) {
  const auto X = mesh.reference_coordinates;
  Kokkos::parallel_for(
      "mechanics::PressureLoad::computeFactors",
      rangePolicy(space, static_cast<std::int64_t>(face_to_nodes.extent(0))),
      KOKKOS_LAMBDA(const std::int64_t face) {
        Triple<double> corners[4];
        for (int c = 0; c < 4; ++c)
          corners[c] = triple(rowOf(X, face_to_nodes(face, c)));
        for (int point = 0; point < 4; ++point) {
          const Triple<double> at = QuadPoint::sum(QuadPoint(point).shape, corners);
          attenuation(face, point) = pressure.attenuationAt({at.x, at.y, at.z});
          delay(face, point) = pressure.delayAt({at.x, at.y, at.z});
        }
      });
}

} // namespace

PressureLoad::PressureLoad(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                           const Pressure& pressure, const std::vector<int>& face_to_nodes)
    : _pressure(pressure), _face_to_nodes(toDevice<View<int* [4]>>(
                               space, "mechanics::PressureLoad::face_to_nodes", face_to_nodes)),
      _face_loads("mechanics::PressureLoad::face_loads", W * numPacks()) {
  listNodes(space, face_to_nodes);
  if (pressure.gaussian) {
    _attenuation = FaceColumns<double, 4>("mechanics::PressureLoad::attenuation", W * numPacks());
    _delay = FaceColumns<double, 4>("mechanics::PressureLoad::delay", W * numPacks());
    computeFactors(space, mesh, pressure, _face_to_nodes, _attenuation, _delay);
  }
  if (pressure.shape.kind == PulseKind::constant)
    return;
  const double farthest =
      pressure.gaussian
          ? allReduce(comm, farthestCorner(space, mesh, pressure.centre, _face_to_nodes), MPI_MAX)
          : 0;
  const double delay = farthest / pressure.speed;
  _end = pressure.start + pressure.shape.duration + delay;
  _end += 1e-12 * (std::fabs(pressure.start) + pressure.shape.duration + delay);
}

void PressureLoad::listNodes(const exec_space& space, const std::vector<int>& face_to_nodes) {
  std::vector<int> nodes, first_corner, corners(face_to_nodes.size());
  std::iota(corners.begin(), corners.end(), 0);
  std::stable_sort(corners.begin(), corners.end(),
                   [&](int a, int b) { return face_to_nodes[a] < face_to_nodes[b]; });
  for (std::size_t k = 0; k < corners.size(); ++k)
    if (const int node = face_to_nodes[corners[k]]; nodes.empty() || nodes.back() != node) {
      nodes.push_back(node);
      first_corner.push_back(static_cast<int>(k));
    }
  first_corner.push_back(static_cast<int>(corners.size()));
  _nodes = toDevice(space, "mechanics::PressureLoad::nodes", nodes);
  _first_corner = toDevice(space, "mechanics::PressureLoad::first_corner", first_corner);
  _corners = toDevice(space, "mechanics::PressureLoad::corners", corners);
}

void PressureLoad::launch(const exec_space& space, const HexMesh& mesh,
                          const View<const double* [3]>& displacement, const TimeSpan& span,
                          const NodalForces& forces) const {
  _has_launched = acts(span);
  if (!_has_launched)
    return;
  const ComputeFaceLoads functor{MeanPressure(_pressure, span),
                                 _pressure.follower,
                                 _pressure.gaussian,
                                 _face_to_nodes,
                                 mesh.reference_coordinates,
                                 displacement,
                                 _attenuation,
                                 _delay,
                                 _face_loads,
                                 forces.quantum.inverse};
  Kokkos::parallel_reduce("mechanics::PressureLoad::add::faces", rangePolicy(space, numPacks()),
                          functor, Kokkos::Sum<std::int64_t, staging_space>(_misfits));
  const auto nodes = _nodes, first_corner = _first_corner, corners = _corners;
  const auto loads = _face_loads;
  const auto values = forces.values;
  constexpr std::int64_t ahead = 16; // nodes ahead whose forces are prefetched
  Kokkos::parallel_for(
      "mechanics::PressureLoad::add::nodes",
      rangePolicy(space, static_cast<std::int64_t>(nodes.extent(0))),
      KOKKOS_LAMBDA(const std::int64_t n) {
        std::int64_t sum[3] = {};
        prefetch(&values(nodes(minOf<std::int64_t>(n + ahead, nodes.extent(0) - 1)),
                         3 * external_force));
        for (int k = first_corner(n); k < first_corner(n + 1); ++k)
          for (int i = 0; i < 3; ++i)
            sum[i] += loads(corners(k) / 4, 3 * (corners(k) % 4) + i);
        for (int i = 0; i < 3; ++i)
          values(nodes(n), 3 * external_force + i) += sum[i];
      });
}

std::int64_t PressureLoad::misfits(const exec_space& space) const {
  if (!_has_launched)
    return 0;
  space.fence();
  return _misfits();
}

} // namespace brickwall::mechanics
