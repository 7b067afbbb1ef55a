// Pressure on faces: consistent nodal loads of the bilinear quadrilateral by 2x2 Gauss quadrature
// (exact for uniform pressure, also on a warped face), on the current face (follower) or the
// reference face (dead), in fixed point; theory.md, equations (20) to (22).
#pragma once

#include "contact/base/triple.hpp"
#include "mechanics/loads/pulse_shape.hpp"
#include "mechanics/mesh/hex_mesh.hpp"
#include "mechanics/mesh/nodal_state.hpp"

#include <cmath>
#include <cstdint>
#include <vector>

namespace brickwall::mechanics {

// p(X, t) = peak shape(t - start - r/speed) exp(-r^2/(2 radius^2)) with r = |X - centre| on the
// reference face.
struct Pressure {
  double peak = 0; // pressure; positive pushes into the body
  PulseShape shape;
  double start = 0; // time
  bool follower = true; // false: dead load
  bool gaussian = false; // false: uniform
  Vec3 centre; // length
  double radius = HUGE_VAL; // length (standard deviation)
  double speed = HUGE_VAL; // speed of the front, length/time; infinite: simultaneous everywhere

  // The factor of space, and the delay by which the front arrives.
  KOKKOS_INLINE_FUNCTION double attenuationAt(const Vec3& X) const {
    const double s = norm(X - centre) / radius;
    return gaussian ? portableExp(-0.5 * s * s) : 1;
  }
  KOKKOS_INLINE_FUNCTION double delayAt(const Vec3& X) const { return norm(X - centre) / speed; }
};

// The mean of a pressure over a span of time as a function of position. Terms that do not depend on
// the position are computed once.
class MeanPressure {
public:
  KOKKOS_INLINE_FUNCTION MeanPressure(const Pressure& pressure, const TimeSpan& span)
      : _pressure(pressure), _span{span.begin - pressure.start, span.end - pressure.start},
        _width(pressure.shape.ofWidth(_span)),
        _is_wave(pressure.gaussian && pressure.speed < HUGE_VAL),
        _everywhere(_is_wave ? 0 : pressure.peak * pressure.shape.mean(_span, _width)) {}

  // Whether the mean is zero at every position without evaluating any: without a peak, before the
  // start, which no front precedes, or where the pulse is 0.
  bool isZero() const {
    return _is_wave ? _pressure.peak == 0 ||
                          (_pressure.shape.kind != PulseKind::constant && _span.end < 0)
                    : _everywhere == 0;
  }

  KOKKOS_INLINE_FUNCTION double at(const Vec3& X) const {
    const double without_distance = afterDelay(_pressure.delayAt(X));
    return without_distance == 0 ? 0 : without_distance * _pressure.attenuationAt(X);
  }
  // The mean where the front arrives later by `delay`, without attenuation.
  KOKKOS_INLINE_FUNCTION double afterDelay(double delay) const {
    if (!_is_wave)
      return _everywhere;
    return _pressure.peak * _pressure.shape.mean({_span.begin - delay, _span.end - delay}, _width);
  }
  KOKKOS_INLINE_FUNCTION bool isWave() const { return _is_wave; }

private:
  Pressure _pressure;
  TimeSpan _span; // relative to the start of the load
  PulseShape::Width _width;
  bool _is_wave;
  double _everywhere;
};

// A point of the 2x2 Gauss quadrature of a quadrilateral: its shape functions and their
// derivatives.
struct QuadPoint {
  double shape[4], along_xi[4], along_eta[4];

  KOKKOS_INLINE_FUNCTION explicit QuadPoint(int point) {
    constexpr double s = 0.57735026918962576451; // 1/sqrt(3)
    const double corner_xi[4] = {-1, 1, 1, -1}, corner_eta[4] = {-1, -1, 1, 1};
    const double xi = s * corner_xi[point], eta = s * corner_eta[point];
    for (int c = 0; c < 4; ++c) {
      const double a = 1 + corner_xi[c] * xi, b = 1 + corner_eta[c] * eta;
      shape[c] = 0.25 * a * b;
      along_xi[c] = 0.25 * corner_xi[c] * b;
      along_eta[c] = 0.25 * corner_eta[c] * a;
    }
  }
  // The sum of factor[c] * x[c].
  template <class Real>
  KOKKOS_INLINE_FUNCTION static Triple<Real> sum(const double (&factor)[4],
                                                 const Triple<Real> (&x)[4]) {
    return Real(factor[0]) * x[0] + Real(factor[1]) * x[1] + Real(factor[2]) * x[2] +
           Real(factor[3]) * x[3];
  }
};

// Nodal loads of a pressure, given at the four QuadPoints, on one quadrilateral with corners x,
// outward by the right-hand rule, or on several in lanes. load_I = -integral p N_I (x_xi cross
// x_eta); the integrand is biquadratic for uniform p.
template <class Real>
KOKKOS_INLINE_FUNCTION void quadPressureLoads(const Real (&pressure)[4], const Triple<Real> (&x)[4],
                                              Triple<Real> (&load)[4]) {
  for (int point = 0; point < 4; ++point) {
    const QuadPoint at(point);
    const Triple<Real> traction =
        -pressure[point] * cross(QuadPoint::sum(at.along_xi, x), QuadPoint::sum(at.along_eta, x));
    for (int c = 0; c < 4; ++c) {
      const Triple<Real> part = Real(at.shape[c]) * traction;
      load[c] = point == 0 ? part : load[c] + part;
    }
  }
}

class PressureLoad {
public:
  // `face_to_nodes` [face][4] holds local mesh nodes with outward normals; each face is on one rank
  // only. Collective.
  PressureLoad(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
               const Pressure& pressure, const std::vector<int>& face_to_nodes);

  // Adds the loads at X + u of the mean pressure over `span` to the external_force columns. The
  // span is that of the kick, from the middle of the last step to the middle of the next, so that
  // consecutive spans join. Returns the number of corner loads on this rank that are NaN or beyond
  // the range of the quantum; these are not added, and EnergyLedger::bookStep takes the count. Not
  // collective.
  std::int64_t add(const exec_space& space, const HexMesh& mesh,
                   const View<const double* [3]>& displacement, const TimeSpan& span,
                   const NodalForces& forces) const {
    launch(space, mesh, displacement, span, forces);
    return misfits(space);
  }
  // The same in two parts: the second waits for the device, if the host has not waited since.
  void launch(const exec_space& space, const HexMesh& mesh,
              const View<const double* [3]>& displacement, const TimeSpan& span,
              const NodalForces& forces) const;
  std::int64_t misfits(const exec_space& space) const;
  // False if the mean over a span is zero everywhere; the same on all ranks.
  bool acts(const TimeSpan& span) const {
    return !(span.begin > _end) && !MeanPressure(_pressure, span).isZero();
  }

  const Pressure& pressure() const { return _pressure; }
  const View<int* [4]>& faceToNodes() const { return _face_to_nodes; }
  // Time at which the pulse has passed the last face; the load does not act afterwards. Infinite
  // for a constant load.
  double end() const {
    return _end;
  }

private:
  template <class T, int columns> // [face][column], with rows for whole packs of faces
  using FaceColumns = Kokkos::View<T* [columns], Kokkos::LayoutLeft, memory_space>;

  std::int64_t numPacks() const { // of simd_width faces
    return dividedUp(static_cast<std::int64_t>(_face_to_nodes.extent(0)), simd_width);
  }
  void listNodes(const exec_space& space, const std::vector<int>& face_to_nodes);

  Pressure _pressure;
  double _end = HUGE_VAL;
  View<int* [4]> _face_to_nodes;
  FaceColumns<double, 4> _attenuation, _delay; // [face][QuadPoint]; if gaussian
  FaceColumns<std::int64_t, 12> _face_loads; // [face][3 * corner + xyz], quanta
  Kokkos::View<std::int64_t, staging_space> _misfits{"mechanics::PressureLoad::misfits"};
  mutable bool _has_launched = false;
  View<int*> _nodes; // with loads
  View<int*> _first_corner, _corners; // 4 * face + corner, by node of _nodes
};

} // namespace brickwall::mechanics
