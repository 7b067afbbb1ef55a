// Pressure on faces: consistent nodal loads of the bilinear quadrilateral by 2x2 Gauss quadrature
// (exact for uniform pressure, also on a warped face), on the current face (follower) or the
// reference face (dead), in fixed point; theory.md, equations (20) to (22).
#pragma once

#include "contact/base/vec3.hpp"
#include "mechanics/loads/pulse_shape.hpp"
#include "mechanics/mesh/hex_mesh.hpp"
#include "mechanics/mesh/nodal_state.hpp"

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

  // Whether the mean is zero at every position without evaluating any: before the start, which no
  // front precedes, or where the pulse is 0.
  bool isZero() const {
    return _is_wave ? _pressure.shape.kind != PulseKind::constant && _span.end < 0
                    : _everywhere == 0;
  }

  KOKKOS_INLINE_FUNCTION double at(const Vec3& X) const {
    if (!_pressure.gaussian)
      return _everywhere;
    const double r = norm(X - _pressure.centre), s = r / _pressure.radius;
    const double without_distance = _is_wave ? ofWave(r / _pressure.speed) : _everywhere;
    return without_distance == 0 ? 0 : without_distance * portableExp(-0.5 * s * s);
  }

private:
  KOKKOS_INLINE_FUNCTION double ofWave(double delay) const {
    return _pressure.peak * _pressure.shape.mean({_span.begin - delay, _span.end - delay}, _width);
  }

  Pressure _pressure;
  TimeSpan _span; // relative to the start of the load
  PulseShape::Width _width;
  bool _is_wave;
  double _everywhere;
};

// Nodal loads of a pressure on one quadrilateral with corners x, outward by the right-hand rule; X
// are the reference corners. load_I = -integral p N_I (x_xi cross x_eta); the integrand is
// biquadratic for uniform p.
KOKKOS_INLINE_FUNCTION void quadPressureLoads(const MeanPressure& pressure, const Vec3 (&X)[4],
                                              const Vec3 (&x)[4], Vec3 (&load)[4]) {
  constexpr double s = 0.57735026918962576451; // 1/sqrt(3)
  const double corner_xi[4] = {-1, 1, 1, -1}, corner_eta[4] = {-1, -1, 1, 1};
  for (int c = 0; c < 4; ++c)
    load[c] = Vec3();
  for (int point = 0; point < 4; ++point) {
    const double xi = s * corner_xi[point], eta = s * corner_eta[point];
    Vec3 position, along_xi, along_eta;
    double shape[4];
    for (int c = 0; c < 4; ++c) {
      const double a = 1 + corner_xi[c] * xi, b = 1 + corner_eta[c] * eta;
      shape[c] = 0.25 * a * b;
      position += shape[c] * X[c];
      along_xi += (0.25 * corner_xi[c] * b) * x[c];
      along_eta += (0.25 * corner_eta[c] * a) * x[c];
    }
    const Vec3 traction = -pressure.at(position) * cross(along_xi, along_eta);
    for (int c = 0; c < 4; ++c)
      load[c] += shape[c] * traction;
  }
}

class PressureLoad {
public:
  // `face_to_nodes` [face][4] holds local mesh nodes with outward normals; each face is on one rank
  // only.
  PressureLoad(const exec_space& space, const HexMesh& mesh, const Pressure& pressure,
               const std::vector<int>& face_to_nodes);

  // Adds the loads at X + u of the mean pressure over `span` to the external_force columns. The
  // span is that of the kick, from the middle of the last step to the middle of the next, so that
  // consecutive spans join. Returns the number of corner loads on this rank that are NaN or beyond
  // the range of the quantum; these are not added, and EnergyLedger::bookStep takes the count. Not
  // collective.
  std::int64_t add(const exec_space& space, const HexMesh& mesh,
                   const View<const double* [3]>& displacement, const TimeSpan& span,
                   const NodalForces& forces) const;

  const Pressure& pressure() const { return _pressure; }
  const View<int* [4]>& faceToNodes() const { return _face_to_nodes; }
  // Time at which the pulse has passed the last of this rank's faces; add() does nothing
  // afterwards. Infinite for a constant load.
  double end() const {
    return _end;
  }

private:
  Pressure _pressure;
  double _end = HUGE_VAL;
  View<int* [4]> _face_to_nodes;
};

} // namespace brickwall::mechanics
