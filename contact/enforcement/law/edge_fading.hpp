// Contact near true edges of a body, where no coplanar face goes on: the force of a node fades out over a short way beyond the
// edge instead of ending there, as the exact gradient of U = k w(xi, eta) p^2/2. Without it a loaded node that slides off an
// edge loses k p^2/2 at once. Point-wise.
#pragma once

#include "contact/enforcement/law/contact_history.hpp"
#include "contact/surface/projection.hpp"

namespace brickwall::contact {

// Bit j of a mask: edge j of a face, from corner j to corner j + 1, is a true edge: eta = -1, xi = 1, eta = 1, xi = -1.
//
// Beyond a true edge the force fades out over the way max(.8 edge_tolerance, 4 P) (in half-lengths, at most 1): a light node that
// is pressed in deep would else cross a narrow way in a few steps, and be thrown back by it. At 4 P the lateral stiffness
// 6 (k p^2/2)/way^2 is a fifth of k; at 2 P, where it is three quarters, the energy on the way errs ten times as much.
struct FadeRegion {
  int mask = 0;
  double lateral_tolerance =
      0.05; // beyond other edges, in half-lengths: the neighbour takes over within it
  double edge_tolerance = 0.1; // beyond true edges, at least
  double half[2] = {1, 1}; // half-lengths of the face along xi and eta

  KOKKOS_INLINE_FUNCTION void measure(const Quad& face) {
    half[0] = 0.25 * norm((face.corner[1] - face.corner[0]) + (face.corner[2] - face.corner[3]));
    half[1] = 0.25 * norm((face.corner[3] - face.corner[0]) + (face.corner[2] - face.corner[1]));
  }
  static constexpr double depths_to_end = 4; // the way over P
  static constexpr double farthest = 1.1; // no contact farther beyond an edge, in half-lengths

  KOKKOS_INLINE_FUNCTION double start() const { return 1 + 0.2 * edge_tolerance; }
  KOKKOS_INLINE_FUNCTION double fadeLength(int direction, double depth) const {
    return minOf(maxOf(0.8 * edge_tolerance, depths_to_end * depth / half[direction]), 1.0);
  }
  KOKKOS_INLINE_FUNCTION bool isTrue(int direction, double parameter) const {
    const int edge = direction == 0 ? (parameter > 0 ? 1 : 3) : (parameter > 0 ? 2 : 0);
    return mask & (1 << edge);
  }
  // Of a contact that has begun; one begins on the face, where w = 1: beyond a true edge it can only end. Beyond other edges the
  // neighbour takes over within `past_inner`.
  KOKKOS_INLINE_FUNCTION bool covers(const FacePoint& point, double past_inner) const {
    return point.valid && point.has_parameters && coversAlong(0, point.xi, point, past_inner) &&
           coversAlong(1, point.eta, point, past_inner);
  }
  KOKKOS_INLINE_FUNCTION bool coversAlong(int direction, double parameter, const FacePoint& point,
                                          double past_inner) const {
    return std::fabs(parameter) < (isTrue(direction, parameter)
                                       ? start() + fadeLength(direction, -point.gap)
                                       : 1 + past_inner);
  }
};

// w along one parameter, 1 up to the start, then t^2 (3 - 2 t) down to 0, and its derivatives.
struct FadeWeight {
  double value = 1;
  double slope = 0; // by the parameter
  double growth = 0; // by the depth, 1/length
  double remaining = 0; // of the parameter, until w = 0

  // The change of w, by its present slope, that ends it.
  KOKKOS_INLINE_FUNCTION double changeToZero() const {
    return value < 1 ? std::fabs(slope) * remaining : HUGE_VAL;
  }
};
KOKKOS_INLINE_FUNCTION FadeWeight fadeWeightAt(const FadeRegion& reach, int direction,
                                               double parameter, double depth) {
  FadeWeight fade_weight;
  const double beyond = std::fabs(parameter) - reach.start();
  if (beyond <= 0 || !reach.isTrue(direction, parameter))
    return fade_weight;
  const double way = reach.fadeLength(direction, depth), t = maxOf(1 - beyond / way, 0.0);
  const double steepness = 6 * t * (1 - t) / way;
  fade_weight.value = t * t * (3 - 2 * t);
  fade_weight.slope = parameter > 0 ? -steepness : steepness;
  fade_weight.remaining = t * way;
  if (way > 0.8 * reach.edge_tolerance && way < 1)
    fade_weight.growth =
        steepness * beyond / way * FadeRegion::depths_to_end / reach.half[direction];
  return fade_weight;
}

// What would move the pair by more than a fifth of the way in one step takes more energy than there is: no more than that.
KOKKOS_INLINE_FUNCTION void keepWithin(double way, double reference_step, double inverse_mass,
                                       FadingForce& fading) {
  const double moves = norm(fading.on_node) * reference_step * reference_step * inverse_mass;
  const double most = 0.2 * way;
  if (moves > most)
    fading.scale(most / moves);
}

// The force that a changing w brings, beside the normal force k w p.
struct LateralForce {
  double fade_weight = 1; // w
  double along_normal = 0; // of the normal force, over k p: (p/2) dw/dP
  Vec3 on_node; // on the node; each face corner takes -N_j of it
  double on_corner[4] = {0, 0, 0, 0}; // along the normal, on the corners besides; sum 0
  double work_to_end = 0; // of these forces, until w = 0
};

// At the point (xi, eta) of the face, which the node stands at with gap -depth; `k` stiffness, `p` what the spring feels.
KOKKOS_INLINE_FUNCTION LateralForce lateralForce(const Quad& face, double xi, double eta,
                                                 const Vec3& normal, double depth,
                                                 const FadeRegion& reach, double k, double p) {
  LateralForce force;
  const FadeWeight along_xi = fadeWeightAt(reach, 0, xi, depth),
                   along_eta = fadeWeightAt(reach, 1, eta, depth);
  force.fade_weight = along_xi.value * along_eta.value;
  force.along_normal =
      0.5 * p * (along_xi.growth * along_eta.value + along_xi.value * along_eta.growth);
  // G = (k p^2/2) dw/d(xi, eta); q = H^-1 G with the Hessian of |node - x(xi, eta)|^2/2
  const double energy = 0.5 * k * p * p;
  force.work_to_end = energy * minOf(along_xi.changeToZero() * along_eta.value,
                                     along_eta.changeToZero() * along_xi.value);
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
