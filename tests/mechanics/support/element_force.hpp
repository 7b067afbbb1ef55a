// Corner forces and energy of one element, distorted corners, arbitrary displacements, for tests.
#pragma once

#include "contact/base/hash.hpp"
#include "mechanics/element/hex8_full.hpp"
#include "mechanics/element/hex8_one_point.hpp"

namespace brickwall::mechanics::testing {

inline void distortedCorners(int seed, double size, CornerCoordinates& X) {
  const double edge[3] = {1.0, 0.7, 1.3};
  for (int c = 0; c < 8; ++c)
    for (int j = 0; j < 3; ++j)
      X[c][j] = 0.5 * edge[j] * cornerXi(c, j) + size * randomOf(1000 * seed + 3 * c + j);
}
inline void randomDisplacement(int seed, double size, CornerCoordinates& u) {
  for (int c = 0; c < 8; ++c)
    for (int j = 0; j < 3; ++j)
      u[c][j] = size * randomOf(7777 * seed + 3 * c + j);
}

struct ElementForce {
  double energy = 0;
  double force[8][3];
  void setForce(const double (&modes)[3][num_modes]) {
    for (int i = 0; i < 3; ++i) {
      double corner[8];
      modesToCorners(modes[i], corner);
      for (int c = 0; c < 8; ++c)
        force[c][i] = corner[c];
    }
  }
};

template <MaterialModel model, class Geometry>
ElementForce onePointOf(const Geometry& geometry, const CornerCoordinates& u, double poisson) {
  double modes[3][num_modes];
  coordinateModes(u, modes);
  OnePointForces<double> forces;
  const auto moduli = ElementModuli::of({model, 1, 1, poisson});
  onePointForces<model>(modes, geometry, stiffnessOf(geometry, moduli, 1.0), true, forces);
  ElementForce result;
  result.energy = forces.material_energy + forces.hourglass_energy;
  result.setForce(forces.force);
  return result;
}
template <MaterialModel model>
ElementForce fullOf(const CornerCoordinates& X, const CornerCoordinates& u, double poisson) {
  double modes[3][num_modes];
  coordinateModes(u, modes);
  FullGeometry<double> geometry;
  coordinateModes(X, geometry.X);
  FullForces<double> forces;
  const Material material{model, 1, 1, poisson};
  fullForces<model>(modes, geometry, material.lambda(), material.mu(), 1.0, true, forces);
  ElementForce result;
  result.energy = forces.material_energy;
  result.setForce(forces.material);
  return result;
}

} // namespace brickwall::mechanics::testing
