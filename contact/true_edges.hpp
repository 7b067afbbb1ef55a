// Contact near true edges of a body, where no coplanar face goes on: the force of a node fades out over a short way beyond the
// edge instead of ending there, as the exact gradient of U = k w(xi, eta) p^2/2. Without it a loaded node that slides off an
// edge loses k p^2/2 at once. Point-wise.
#pragma once

#include "contact/projection.hpp"

namespace brickwall::contact {

// Bit j of a mask: edge j of a face, from corner j to corner j + 1, is a true edge: eta = -1, xi = 1, eta = 1, xi = -1.
struct EdgeReach {
  int mask = 0;
  double lateral_tolerance =
      0.05; // beyond other edges, in half-lengths: the neighbour takes over within it
  double edge_tolerance = 0.1; // beyond true edges: there the force has faded out

  KOKKOS_INLINE_FUNCTION double beyond(int edge) const {
    return mask & (1 << edge) ? edge_tolerance : lateral_tolerance;
  }
  KOKKOS_INLINE_FUNCTION bool covers(const FacePoint& point) const {
    if (point.activeWithin(lateral_tolerance))
      return true;
    return mask != 0 && point.valid && point.has_parameters && point.xi < 1 + beyond(1) &&
           -point.xi < 1 + beyond(3) && point.eta < 1 + beyond(2) && -point.eta < 1 + beyond(0);
  }
};

// w along one parameter and its derivative: 1 up to a fifth of the reach beyond the edge, then t^2 (3 - 2 t) down to 0.
struct Taper {
  double value = 1, slope = 0;
};
KOKKOS_INLINE_FUNCTION Taper taperAt(double parameter, bool is_true_edge, double reach) {
  Taper taper;
  const double way = 0.8 * reach, left = 1 + reach - std::fabs(parameter);
  if (!is_true_edge || left >= way)
    return taper;
  const double t = maxOf(left / way, 0.0);
  taper.value = t * t * (3 - 2 * t);
  taper.slope = (parameter > 0 ? -6 : 6) * t * (1 - t) / way;
  return taper;
}

// The force that a changing w brings, beside the normal force k w p.
struct LateralForce {
  double taper = 1; // w
  Vec3 on_node; // on the node; each face corner takes -N_j of it
  double on_corner[4] = {0, 0, 0, 0}; // along the normal, on the corners besides; sum 0
};

// At the point (xi, eta) of the face, which the node stands at with gap -depth; `k` stiffness, `p` what the spring feels.
KOKKOS_INLINE_FUNCTION LateralForce lateralForce(const Quad& face, double xi, double eta,
                                                 const Vec3& normal, double depth,
                                                 const EdgeReach& reach, double k, double p) {
  LateralForce force;
  const Taper along_xi = taperAt(xi, (reach.mask & (xi > 0 ? 2 : 8)) != 0, reach.edge_tolerance);
  const Taper along_eta = taperAt(eta, (reach.mask & (eta > 0 ? 4 : 1)) != 0, reach.edge_tolerance);
  force.taper = along_xi.value * along_eta.value;
  // G = (k p^2/2) dw/d(xi, eta); q = H^-1 G with the Hessian of |node - x(xi, eta)|^2/2
  const double energy = 0.5 * k * p * p;
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
