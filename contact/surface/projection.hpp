// Closest point projection onto a face: Newton's method with the full Hessian on the bilinear quad,
// then without the curvature term; exact on triangles (a repeated corner); four triangles about the
// centroid where both fail. All arithmetic is relative to the point, so that flat faces give
// exactly flat normals.
// Equations: theory.md, section 4, eqs. (5) to (7).
#pragma once

#include "contact/base/triple.hpp"

#include <cmath>

namespace brickwall::contact {

// The corners of a face, counter-clockwise seen from outside; a triangle repeats a corner.
struct Quad {
  Vec3 corner[4];
};

// The projection of a point onto a face.
struct FacePoint {
  double weight[4] = {0, 0, 0, 0}; // N_j, sum 1; slightly negative beyond an edge
  Vec3 normal; // outward unit normal there
  double gap = 0; // g = (point - x_c) . normal, length; negative inside the body
  // How far outside the face, in half-lengths: max(|xi|, |eta|) - 1; <= 0 inside.
  double excess = HUGE_VAL;
  double xi = 0, eta = 0; // on the quad; without meaning unless has_parameters
  bool has_parameters = false; // a stationary point of the distance on the bilinear quad
  bool valid = false; // false: no projection near this face, or a degenerate face

  KOKKOS_INLINE_FUNCTION bool activeWithin(double lateral_tolerance) const {
    return valid && excess <= lateral_tolerance;
  }
};

namespace projection {

constexpr int max_iterations = 20;
constexpr double far_outside = 3.0; // iterates beyond this parameter value belong to another face
constexpr double last_step = 1e-8; // convergence is quadratic: the next step would be below 1e-15
// relative to A C: below it the curvature term is dropped
constexpr double least_determinant = 0.01;

// a / length, by division: an axis-parallel vector then becomes exactly a unit vector.
KOKKOS_INLINE_FUNCTION Vec3 scaledDown(const Vec3& a, double length) {
  return {a.x / length, a.y / length, a.z / length};
}

// Plane of a triangle; returns barycentric coordinates of the origin's projection, or false if
// degenerate.
KOKKOS_INLINE_FUNCTION bool barycentric(const Vec3& a, const Vec3& b, const Vec3& c,
                                        double (&lambda)[3], Vec3& unit_normal) {
  const Vec3 area = cross(b - a, c - a);
  const double square = dot(area, area);
  if (!(square > 0))
    return false;
  const double inverse = 1.0 / square;
  lambda[1] = inverse * dot(area, cross(c - a, a));
  lambda[2] = inverse * dot(area, cross(a, b - a));
  lambda[0] = 1.0 - lambda[1] - lambda[2];
  unit_normal = scaledDown(area, std::sqrt(square));
  return true;
}

// Index of a corner that repeats its successor, or -1 for a true quad.
KOKKOS_INLINE_FUNCTION int repeatedCorner(const Vec3 (&q)[4]) {
  for (int j = 0; j < 4; ++j) {
    const Vec3 edge = q[(j + 1) & 3] - q[j];
    if (edge.x == 0 && edge.y == 0 && edge.z == 0)
      return j;
  }
  return -1;
}

KOKKOS_INLINE_FUNCTION FacePoint ontoTriangle(const Vec3 (&q)[4], int repeated) {
  FacePoint found;
  const int a = (repeated + 1) & 3, b = (repeated + 2) & 3, c = (repeated + 3) & 3;
  double lambda[3];
  if (!barycentric(q[a], q[b], q[c], lambda, found.normal))
    return found;
  found.weight[a] = lambda[0];
  found.weight[b] = lambda[1];
  found.weight[c] = lambda[2];
  // An edge at lambda = 0 is the edge xi = 1 of a quad with lambda = (1 - xi)/2.
  found.excess = -2.0 * minOf(lambda[0], minOf(lambda[1], lambda[2]));
  found.gap = -dot(q[a], found.normal);
  found.valid = found.excess < far_outside;
  return found;
}

// Whether the origin is far outside the quad centre + xi a + eta b + xi eta c, by the first
// Gauss-Newton step from its centre. On a flat face, with c = alpha a + beta b, this step errs by
// (alpha, beta) xi eta. |alpha| and |beta| are at most 1 on a convex one, |xi| and |eta| at most
// 1.5 (largest tolerance) on a face in contact: its step is shorter than far_outside + |alpha|.
template <class Real>
KOKKOS_INLINE_FUNCTION typename MaskOf<Real>::type
isFarByLines(const Triple<Real>& centre, const Triple<Real>& a, const Triple<Real>& b,
             const Triple<Real>& c) {
  const Real A = dot(a, a), B = dot(a, b), C = dot(b, b);
  const Real to_a = dot(a, centre), to_b = dot(b, centre), c_a = dot(a, c), c_b = dot(b, c);
  const Real limit = Real(far_outside) * (A * C - B * B);
  return (magnitude(C * to_a - B * to_b) > limit + magnitude(C * c_a - B * c_b)) |
         (magnitude(A * to_b - B * to_a) > limit + magnitude(A * c_b - B * c_a));
}

// Divides the quad into four triangles about its centroid and takes the one that the origin
// projects into best.
KOKKOS_INLINE_FUNCTION FacePoint ontoFourTriangles(const Vec3 (&q)[4]) {
  FacePoint found;
  const Vec3 centre = 0.25 * ((q[0] + q[1]) + (q[2] + q[3]));
  double best = -HUGE_VAL;
  for (int j = 0; j < 4; ++j) {
    const int next = (j + 1) & 3;
    double lambda[3];
    Vec3 normal;
    if (!barycentric(q[j], q[next], centre, lambda, normal))
      continue;
    // The outer edge, lambda[2] = 0, may be overshot.
    const double inside = minOf(lambda[0], lambda[1]);
    if (inside <= best)
      continue;
    best = inside;
    for (int i = 0; i < 4; ++i)
      found.weight[i] = 0.25 * lambda[2];
    found.weight[j] += lambda[0];
    found.weight[next] += lambda[1];
    found.normal = normal;
    found.gap = -dot(q[j], normal);
    found.excess = -lambda[2];
    found.valid = found.excess < far_outside;
  }
  return found;
}

} // namespace projection

// Result of Newton's method for a stationary point of the distance from the origin to the bilinear
// quad q, for one quad or in lanes. `found`: converged; `nowhere`: there is none near the face;
// otherwise the four triangles must decide.
template <class Real>
struct NewtonPoint {
  using Mask = typename MaskOf<Real>::type;
  Real xi, eta, gap, excess;
  Real weight[4];
  Triple<Real> normal;
  Mask found, nowhere;
};

// Where the method leaves the face, it begins anew from the centre without the curvature term: the
// steps of a flat face (Gauss-Newton). Lanes outside `wanted` are neither found nor nowhere. No
// quad may repeat a corner.
template <class Real>
KOKKOS_INLINE_FUNCTION NewtonPoint<Real> ontoBilinear(const Triple<Real> (&q)[4],
                                                      typename MaskOf<Real>::type wanted) {
  using namespace projection;
  using Mask = typename MaskOf<Real>::type;
  NewtonPoint<Real> point;
  // x(xi, eta) = centre + xi a + eta b + xi eta c, in differences so that equal coordinates cancel
  // exactly.
  const Real quarter = 0.25;
  const Triple<Real> bottom = q[1] - q[0], top = q[2] - q[3], left = q[3] - q[0],
                     right = q[2] - q[1];
  const Triple<Real> centre = quarter * ((q[0] + q[1]) + (q[2] + q[3]));
  const Triple<Real> a = quarter * (bottom + top), b = quarter * (left + right),
                     c = quarter * (top - bottom);
  const Mask parallelogram = dot(c, c) <= Real(1e-30) * (dot(a, a) + dot(b, b));
  Real xi = 0, eta = 0;
  Mask left_to_do = wanted, converged = false, is_flat = false;
  point.nowhere = false;
  for (int iteration = 0; iteration < max_iterations && isAny(left_to_do); ++iteration) {
    const Triple<Real> t_xi = a + eta * c, t_eta = b + xi * c;
    const Triple<Real> d = -(centre + xi * a + eta * b + (xi * eta) * c);
    const Real A = dot(t_xi, t_xi), C = dot(t_eta, t_eta), plain = dot(t_xi, t_eta);
    Real B = plain - dot(d, c);
    Real determinant = A * C - B * B;
    const Mask curved = (determinant > Real(least_determinant) * A * C) & !is_flat;
    B = where(curved, B, plain);
    determinant = A * C - B * B;
    const Mask has_step = left_to_do & (determinant > Real(0.0));
    const Real r_xi = dot(t_xi, d), r_eta = dot(t_eta, d);
    const Real step_xi = (C * r_xi - B * r_eta) / determinant;
    const Real step_eta = (A * r_eta - B * r_xi) / determinant;
    xi = where(has_step, xi + step_xi, xi);
    eta = where(has_step, eta + step_eta, eta);
    const Mask near = (magnitude(xi) <= Real(far_outside)) & (magnitude(eta) <= Real(far_outside));
    const Mask is_lost = left_to_do & !(has_step & near);
    left_to_do = has_step & near;
    const Mask is_last = parallelogram | ((magnitude(step_xi) < Real(last_step)) &
                                          (magnitude(step_eta) < Real(last_step)));
    converged = converged | (left_to_do & is_last);
    left_to_do = left_to_do & !is_last;
    if (isAny(is_lost)) {
      point.nowhere = point.nowhere | (is_lost & (parallelogram | isFarByLines(centre, a, b, c)));
      const Mask again = is_lost & !point.nowhere & !is_flat;
      xi = where(again, Real(0.0), xi);
      eta = where(again, Real(0.0), eta);
      is_flat = is_flat | again;
      left_to_do = left_to_do | again;
    }
  }
  const Triple<Real> area = cross(a + eta * c, b + xi * c);
  const Real length = squareRoot(dot(area, area));
  const Mask has_normal = length > Real(0.0);
  point.found = converged & has_normal;
  point.nowhere = point.nowhere | (converged & !has_normal);
  point.normal = {area.x / length, area.y / length, area.z / length};
  point.gap = -dot(centre + xi * a + eta * b + (xi * eta) * c, point.normal);
  const Real one = 1.0;
  point.weight[0] = quarter * (one - xi) * (one - eta);
  point.weight[1] = quarter * (one + xi) * (one - eta);
  point.weight[2] = quarter * (one + xi) * (one + eta);
  point.weight[3] = quarter * (one - xi) * (one + eta);
  point.excess = maxOf(magnitude(xi), magnitude(eta)) - one;
  point.xi = xi;
  point.eta = eta;
  return point;
}

// Projects `point` onto the face. `valid` says whether the projection lies near the face.
KOKKOS_INLINE_FUNCTION FacePoint project(const Quad& face, const Vec3& point) {
  using namespace projection;
  // As a struct: compilers for devices put arrays of one type in the same local memory, and this
  // one is read with a variable index.
  const Quad relative = {{face.corner[0] - point, face.corner[1] - point, face.corner[2] - point,
                          face.corner[3] - point}};
  const Vec3(&q)[4] = relative.corner;
  const int repeated = repeatedCorner(q);
  if (repeated >= 0)
    return ontoTriangle(q, repeated);
  const Triple<double> corners[4] = {triple(q[0]), triple(q[1]), triple(q[2]), triple(q[3])};
  const NewtonPoint<double> newton = ontoBilinear(corners, true);
  FacePoint found;
  if (newton.nowhere)
    return found;
  if (!newton.found)
    return ontoFourTriangles(q);
  found.normal = {newton.normal.x, newton.normal.y, newton.normal.z};
  found.gap = newton.gap;
  for (int j = 0; j < 4; ++j)
    found.weight[j] = newton.weight[j];
  found.excess = newton.excess;
  found.xi = newton.xi;
  found.eta = newton.eta;
  found.has_parameters = true;
  found.valid = true;
  return found;
}

// Mean plane of a face, for a quick test of a node before the projection.
struct MeanPlane {
  Vec3 normal; // unit; zero for a degenerate face
  double offset = 0; // normal . centroid, length
  double warp = 0; // greatest distance of a corner from the plane, length
  double area = 0; // |half the cross product of the diagonals|

  // True if a point that projects onto the face within `lateral_tolerance` cannot lie deeper than
  // `depth` behind it.
  KOKKOS_INLINE_FUNCTION bool surelyOutside(const Vec3& point, double lateral_tolerance,
                                            double depth) const {
    const double stretch = (1 + lateral_tolerance) * (1 + lateral_tolerance);
    return dot(normal, point) - offset > warp * stretch - depth;
  }
};

// The data of a candidate face that are read first, in one cache line. For faces of other ranks
// around a node, normal and area only.
struct alignas(16) FaceRecord {
  MeanPlane plane;
  global_id side = -1, id = -1;
};

// Half the cross product of the diagonals: the exact area vector of the bilinear patch, and of a
// triangle.
KOKKOS_INLINE_FUNCTION Vec3 areaVector(const Quad& f) {
  return 0.5 * cross(f.corner[2] - f.corner[0], f.corner[3] - f.corner[1]);
}

// Normal and area only, from the area vector of a face.
KOKKOS_INLINE_FUNCTION MeanPlane planeOfArea(const Vec3& area) {
  MeanPlane plane;
  plane.area = norm(area);
  if (plane.area > 0)
    plane.normal = projection::scaledDown(area, plane.area);
  return plane;
}

KOKKOS_INLINE_FUNCTION MeanPlane meanPlane(const Quad& f) {
  MeanPlane plane = planeOfArea(areaVector(f));
  const Vec3 sum = (f.corner[0] + f.corner[1]) + (f.corner[2] + f.corner[3]);
  plane.offset = 0.25 * dot(plane.normal, sum);
  // The corners stand alternately above and below the mean plane by the same distance.
  const Vec3 twist = (f.corner[0] - f.corner[1]) + (f.corner[2] - f.corner[3]);
  plane.warp = 0.25 * std::fabs(dot(plane.normal, twist));
  return plane;
}

} // namespace brickwall::contact
