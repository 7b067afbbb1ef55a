// Fading of contact forces beyond true edges, eqs. (24) to (26) of theory.md. At a true edge no
// coplanar face continues the surface. There the force of a node fades out over a short length as
// the exact gradient of U = k w(xi, eta) p^2/2; if it ended abruptly, a loaded node that slides off
// an edge would lose k p^2/2 at once. Point-wise.
#pragma once

#include "contact/enforcement/law/contact_history.hpp"
#include "contact/surface/projection.hpp"

namespace brickwall::contact {

// A fade length, eq. (25), with its derivative by x, which is in proportion to the penetration:
// max(least, x), from most/2 on bent to `most` with a continuous slope, since the force along the
// normal jumps where the slope does.
struct FadeLength {
  double value, slope;

  KOKKOS_INLINE_FUNCTION static FadeLength at(double x, double least, double most) {
    const double left = maxOf(1.5 * most - x, 0.0);
    if (left < most)
      return {most - left * left / (2 * most), left / most};
    return x > least ? FadeLength{x, 1} : FadeLength{least, 0};
  }
};

// Bit j of `mask`: edge j of the face, from corner j to corner j + 1, is a true edge: eta = -1, xi
// = 1, eta = 1, xi = -1.
//
// The fade length grows with 4 P from 0.8 edge_tolerance to 1, in half-lengths. A shorter one would
// let a light node with a deep penetration cross it in a few steps, and throw it back: at 4 P the
// lateral stiffness 6 (k p^2/2)/length^2 is a fifth of k; at 2 P it is three quarters of k, and the
// energy in between errs ten times as much.
struct FadeRegion {
  int mask = 0;
  // beyond inner edges, in half-lengths; the neighbour takes over within it
  double lateral_tolerance = 0.05;
  double edge_tolerance = 0.1; // least extent beyond true edges, in half-lengths
  double half_length[2] = {1, 1}; // of the face along xi and eta, length

  KOKKOS_INLINE_FUNCTION void measure(const Quad& face) {
    half_length[0] =
        0.25 * norm((face.corner[1] - face.corner[0]) + (face.corner[2] - face.corner[3]));
    half_length[1] =
        0.25 * norm((face.corner[3] - face.corner[0]) + (face.corner[2] - face.corner[1]));
  }
  static constexpr double fade_depth_ratio = 4; // fade length over P
  // largest distance of any contact beyond an edge, in half-lengths
  static constexpr double max_excess = 1.1;

  KOKKOS_INLINE_FUNCTION double start() const { return 1 + 0.2 * edge_tolerance; }
  KOKKOS_INLINE_FUNCTION FadeLength fadeLength(int direction, double depth) const {
    return FadeLength::at(fade_depth_ratio * depth / half_length[direction], 0.8 * edge_tolerance,
                          1);
  }
  KOKKOS_INLINE_FUNCTION bool isTrue(int direction, double parameter) const {
    const int edge = direction == 0 ? (parameter > 0 ? 1 : 3) : (parameter > 0 ? 2 : 0);
    return mask & (1 << edge);
  }
  // Whether an active contact at `point` continues. A contact becomes active only on the face,
  // where w = 1. Beyond an inner edge the neighbour takes over within `inner_tolerance`.
  KOKKOS_INLINE_FUNCTION bool covers(const FacePoint& point, double inner_tolerance) const {
    return point.valid && point.has_parameters &&
           coversAlong(0, point.xi, point, inner_tolerance) &&
           coversAlong(1, point.eta, point, inner_tolerance);
  }
  KOKKOS_INLINE_FUNCTION bool coversAlong(int direction, double parameter, const FacePoint& point,
                                          double inner_tolerance) const {
    return std::fabs(parameter) < (isTrue(direction, parameter)
                                       ? start() + fadeLength(direction, -point.gap).value
                                       : 1 + inner_tolerance);
  }
};

// w along one parameter, eq. (24): 1 up to start(), then t^2 (3 - 2 t) down to 0, with its
// derivatives.
struct FadeWeight {
  double value = 1;
  double slope = 0; // dw/dxi
  double depth_slope = 0; // dw/dP, 1/length
  double remaining = 0; // parameter distance until w = 0

  // At this parameter distance beyond start(); `per_depth` is dl/dP.
  KOKKOS_INLINE_FUNCTION void set(double beyond, bool at_upper_end, const FadeLength& length,
                                  double per_depth) {
    const double t = maxOf(1 - beyond / length.value, 0.0);
    const double steepness = 6 * t * (1 - t) / length.value;
    value = t * t * (3 - 2 * t);
    slope = at_upper_end ? -steepness : steepness;
    depth_slope = steepness * beyond / length.value * per_depth;
    remaining = t * length.value;
  }

  // Change of w until the contact ends, extrapolated with the present slope.
  KOKKOS_INLINE_FUNCTION double changeToZero() const { return std::fabs(slope) * remaining; }
};

// The same of the product of two, beyond the edge whose end is nearest in units of its fade length.
// Beyond the other one it may be about to begin, with hardly any slope.
KOKKOS_INLINE_FUNCTION double changeToZero(const FadeWeight& a, const FadeWeight& b) {
  return maxOf(a.changeToZero() * b.value, b.changeToZero() * a.value);
}

KOKKOS_INLINE_FUNCTION FadeWeight fadeWeightAt(const FadeRegion& region, int direction,
                                               double parameter, double depth) {
  FadeWeight fade_weight;
  const double beyond = std::fabs(parameter) - region.start();
  if (beyond <= 0 || !region.isTrue(direction, parameter))
    return fade_weight;
  const FadeLength length = region.fadeLength(direction, depth);
  fade_weight.set(beyond, parameter > 0, length,
                  length.slope * FadeRegion::fade_depth_ratio / region.half_length[direction]);
  return fade_weight;
}

// Limits the lateral force to one that moves the pair by a fifth of the fade length in a step; a
// larger motion would need more energy than is stored.
KOKKOS_INLINE_FUNCTION void limitLateralMotion(double fade_length, double reference_step,
                                               double inverse_mass, FadingForce& fading) {
  const double moves = norm(fading.on_node) * reference_step * reference_step * inverse_mass;
  const double most = 0.2 * fade_length;
  if (moves > most)
    fading.scale(most / moves);
}

// Forces from the gradient of w, in addition to the normal force k w p; eq. (26).
struct LateralForce {
  double fade_weight = 1; // w
  double along_normal = 0; // normal force over k p: (p/2) dw/dP
  Vec3 on_node; // force on the node; each corner takes -N_j of it
  double on_corner[4] = {0, 0, 0, 0}; // additional normal forces on the corners; sum 0
  double work_to_end = 0; // work of these forces until w = 0, energy
};

// At (xi, eta) of the face, where the node has the gap -depth; `k` is the stiffness and `p` the
// deformation of the spring.
KOKKOS_INLINE_FUNCTION LateralForce lateralForce(const Quad& face, double xi, double eta,
                                                 const Vec3& normal, double depth,
                                                 const FadeRegion& region, double k, double p) {
  LateralForce force;
  const FadeWeight along_xi = fadeWeightAt(region, 0, xi, depth),
                   along_eta = fadeWeightAt(region, 1, eta, depth);
  force.fade_weight = along_xi.value * along_eta.value;
  force.along_normal =
      0.5 * p * (along_xi.depth_slope * along_eta.value + along_xi.value * along_eta.depth_slope);
  // G = (k p^2/2) dw/d(xi, eta); q = H^-1 G with the Hessian of |node - x(xi, eta)|^2/2
  const double energy = 0.5 * k * p * p;
  force.work_to_end = energy * changeToZero(along_xi, along_eta);
  const double g_xi = energy * along_xi.slope * along_eta.value;
  const double g_eta = energy * along_xi.value * along_eta.slope;
  if (g_xi == 0 && g_eta == 0)
    return force;
  const Vec3 bottom = face.corner[1] - face.corner[0], top = face.corner[2] - face.corner[3];
  const Vec3 left = face.corner[3] - face.corner[0], right = face.corner[2] - face.corner[1];
  const Vec3 c = 0.25 * (top - bottom);
  const Vec3 t_xi = 0.25 * (bottom + top) + eta * c, t_eta = 0.25 * (left + right) + xi * c;
  const Vec3 d = -depth * normal; // node - x(xi, eta)
  const double A = dot(t_xi, t_xi), C = dot(t_eta, t_eta), B = dot(t_xi, t_eta) - dot(d, c);
  const double determinant = A * C - B * B;
  if (!(determinant > 0))
    return force;
  const double q_xi = (C * g_xi - B * g_eta) / determinant;
  const double q_eta = (A * g_eta - B * g_xi) / determinant;
  force.on_node = -(q_xi * t_xi + q_eta * t_eta);
  const double along = 0.25 * depth;
  force.on_corner[0] = along * (-q_xi * (1 - eta) - q_eta * (1 - xi));
  force.on_corner[1] = along * (q_xi * (1 - eta) - q_eta * (1 + xi));
  force.on_corner[2] = along * (q_xi * (1 + eta) + q_eta * (1 + xi));
  force.on_corner[3] = along * (-q_xi * (1 + eta) + q_eta * (1 - xi));
  return force;
}

} // namespace brickwall::contact
