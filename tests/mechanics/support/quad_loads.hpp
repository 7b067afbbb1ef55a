// Loads of a pressure on one quadrilateral, for tests.
#pragma once

#include "mechanics/loads/pressure_load.hpp"

namespace brickwall::mechanics::testing {

// X are the reference corners, where the pressure is taken, and x the current ones.
inline void quadLoads(const MeanPressure& pressure, const Vec3 (&X)[4], const Vec3 (&x)[4],
                      Vec3 (&load)[4]) {
  Triple<double> reference[4], current[4], loads[4];
  double at_points[4];
  for (int c = 0; c < 4; ++c)
    reference[c] = triple(X[c]), current[c] = triple(x[c]);
  for (int point = 0; point < 4; ++point) {
    const Triple<double> at = QuadPoint::sum(QuadPoint(point).shape, reference);
    at_points[point] = pressure.at({at.x, at.y, at.z});
  }
  quadPressureLoads(at_points, current, loads);
  for (int c = 0; c < 4; ++c)
    load[c] = {loads[c].x, loads[c].y, loads[c].z};
}

} // namespace brickwall::mechanics::testing
