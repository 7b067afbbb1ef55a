// Projection of a point onto several faces, in SIMD lanes, with the bits of project(). Host code.
#pragma once

#include "contact/base/lane_arrays.hpp"
#include "contact/surface/projection.hpp"

namespace brickwall::contact {

// Fills the first `count` <= W of `points`; quadOf(k) is face k.
template <int W, class QuadOf>
inline void projectAtOnce(const QuadOf& quadOf, int count, const Vec3& x, FacePoint* points) {
  using Real = PackOf<W>;
  if (count <= 1) {
    if (count == 1)
      points[0] = project(quadOf(0), x);
    return;
  }
  LaneTriple<Real> corner[4];
  bool is_quad[W];
  for (int lane = 0; lane < W; ++lane) {
    const Quad quad = quadOf(minOf(lane, count - 1));
    Vec3 q[4];
    for (int j = 0; j < 4; ++j) {
      q[j] = quad.corner[j] - x;
      corner[j].set(lane, q[j]);
    }
    is_quad[lane] = projection::repeatedCorner(q) < 0;
  }
  const Triple<Real> q[4] = {corner[0], corner[1], corner[2], corner[3]};
  const NewtonPoint<Real> newton = ontoBilinear(q, MaskPackOf<W>(true));
  LaneArray<Real> weight[4], found, gap, excess, xi, eta;
  LaneTriple<Real> normal;
  found = where(newton.found & !newton.nowhere, Real(1.0), Real(0.0));
  for (int j = 0; j < 4; ++j)
    weight[j] = newton.weight[j];
  gap = newton.gap;
  excess = newton.excess;
  xi = newton.xi;
  eta = newton.eta;
  normal = newton.normal;
  for (int k = 0; k < count; ++k) {
    FacePoint& point = points[k];
    if (!is_quad[k] || found[k] == 0) {
      point = project(quadOf(k), x);
      continue;
    }
    for (int j = 0; j < 4; ++j)
      point.weight[j] = weight[j][k];
    point.normal = normal.of(k);
    point.gap = gap[k];
    point.excess = excess[k];
    point.xi = xi[k];
    point.eta = eta[k];
    point.has_parameters = point.valid = true;
  }
}

} // namespace brickwall::contact
