// Physical stabilisation of the one-point hexahedron (hex8_one_point.hpp): the stiffness of its
// hourglass modes, theory.md, equation (11).
#pragma once

#include "mechanics/element/hex8_one_point_geometry.hpp"
#include "mechanics/element/material.hpp"

namespace brickwall::mechanics {

// Moduli of one material in the form that the element uses.
struct ElementModuli {
  double lambda = 0, mu = 0, poisson = 0;
  double bending = 0; // E / (6 (1 - nu^2))
  double torsion = 0; // mu / 6
  double fourth = 0; // E / 18
  KOKKOS_INLINE_FUNCTION static ElementModuli of(const Material& m) {
    return {m.lambda(), m.mu(),       m.poisson, m.youngs / (6 * (1 - m.poisson * m.poisson)),
            m.mu() / 6, m.youngs / 18};
  }
};

// Moduli times -volume/quantum, so that forces come in quanta. Those of the hourglass energy are
// also divided by 64, since the hourglass strains are 8 g. Modulus is double where all lanes share
// it.
template <class Modulus>
struct OnePointStiffness {
  Modulus lambda, mu;
  Modulus bend, bend_cross; // a pair of bending modes: E/(1 - nu^2)/3, and nu times that
  Modulus twist, twist_own[3]; // mu/3; the excess of each mode over the sum of the three
  Modulus fourth; // E/9
  double inverse_factor; // energy = inverse_factor * (energy by these moduli)
};
struct BrickStiffness {
  double lambda, mu;
  double own[3][3]; // [mode a][axis]: bending off the diagonal, torsion on it
  double cross[3][3]; // couples mode (a, i) with (i, a) in bending; symmetric
  double twist[3]; // couples modes (i, i) and (j, j), with i and j different from the index
  double fourth[3];
  double inverse_factor;
};
template <class Geometry>
struct StiffnessOf;
template <class Real>
struct StiffnessOf<OnePointGeometry<Real>> {
  using type = OnePointStiffness<Real>;
};
template <>
struct StiffnessOf<OnePointBox> {
  using type = OnePointStiffness<double>;
};
template <>
struct StiffnessOf<OnePointBrick> {
  using type = BrickStiffness;
};

// `scale` is 1/quantum.
template <class Geometry>
KOKKOS_INLINE_FUNCTION typename StiffnessOf<Geometry>::type
stiffnessOf(const Geometry& geometry, const ElementModuli& moduli, double scale) {
  typename StiffnessOf<Geometry>::type result;
  const auto factor = -scale * geometry.volume;
  result.lambda = factor * moduli.lambda;
  result.mu = factor * moduli.mu;
  result.bend = factor * (moduli.bending / 32);
  result.bend_cross = factor * (moduli.bending / 32 * moduli.poisson);
  result.twist = factor * (moduli.torsion / 32);
  for (int i = 0; i < 3; ++i)
    result.twist_own[i] = result.twist * (geometry.thinness[i] - 1.0);
  result.fourth = factor * (moduli.fourth / 32);
  result.inverse_factor = -1 / scale;
  return result;
}
KOKKOS_INLINE_FUNCTION BrickStiffness stiffnessOf(const OnePointBrick& brick,
                                                  const ElementModuli& moduli, double scale) {
  BrickStiffness result;
  const double(&l)[3] = brick.inverse_length;
  const double factor = -scale * brick.volume;
  const double bend = factor * (moduli.bending / 32), twist = factor * (moduli.torsion / 32);
  result.lambda = factor * moduli.lambda;
  result.mu = factor * moduli.mu;
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    for (int i = 0; i < 3; ++i) {
      result.own[a][i] = a == i ? twist * (l[b] * l[b] + l[c] * l[c]) : bend * (l[i] * l[i]);
      result.cross[a][i] = bend * moduli.poisson * (l[a] * l[i]);
    }
    result.twist[a] = twist * (l[b] * l[c]);
    result.fourth[a] = factor * (moduli.fourth / 32) * (l[a] * l[a]);
  }
  result.inverse_factor = -1 / scale;
  return result;
}

// s = d(U_h/V)/dq for the corotated hourglass strains q [a][local axis]. Each strain is divided by
// the half-edge of its axis, and U_h/V is the sum of
//   bending  E/(1 - nu^2)/6 (p^2 + r^2 + 2 nu p r),
//            (p, r) = (q3x/a, q1z/c), (q2x/a, q1y/b), (q3y/b, q2z/c)
//   torsion  mu/6 (t1^2 + t2^2 + t3^2), t1 = q1x/b + q2y/a, t2 = q2y/c + q3z/b, t3 = q3z/a + q1x/c
//   fourth   E/18 [(q4x/a)^2 + (q4y/b)^2 + (q4z/c)^2]
template <class Real, class Modulus>
KOKKOS_INLINE_FUNCTION void hourglassStress(const Real (&q)[num_hourglass_modes][3],
                                            const OnePointStiffness<Modulus>& k,
                                            Real (&s)[num_hourglass_modes][3]) {
  const Real sum = k.twist * (q[0][0] + q[1][1] + q[2][2]);
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < 3; ++i)
      s[a][i] = a == i ? Real(k.twist_own[a] * q[a][a] + sum)
                       : Real(k.bend * q[a][i] + k.bend_cross * q[i][a]);
  for (int i = 0; i < 3; ++i)
    s[3][i] = k.fourth * q[3][i];
}

} // namespace brickwall::mechanics
